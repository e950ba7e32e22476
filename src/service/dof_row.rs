//! Values of degrees of freedom as a request brings them: a list, or float32 among its raw bytes. They stay as they came until they are
//! used, so that requests that refer to the same bytes many times take no more memory than that.
//! Never lives here: which degrees of freedom they are of.

use crate::protocol::FieldFault;
use crate::protocol::pose::DofValues;
use bytes::Bytes;
use std::ops::Range;
use std::sync::Arc;

/// A clone, or a part, refers to the same memory.
#[derive(Debug, Clone)]
pub(super) enum DofRow {
    List(Arc<Vec<f64>>, Range<usize>),
    /// Little-endian, in whole words.
    Float32(Bytes),
}

/// Bytes of a float32.
const WORD: usize = 4;

impl DofRow {
    /// A fault is as seen from the values.
    pub(super) fn new(values: DofValues, attached: &Bytes) -> Result<Self, FieldFault> {
        let attach = match values {
            DofValues::List(values) => {
                let all = 0..values.len();
                return Ok(Self::List(Arc::new(values), all));
            }
            DofValues::Attached { attach } => attach,
        };
        let bytes = attach
            .of(attached)
            .map_err(|fault| fault.within("attach"))?;
        if !bytes.len().is_multiple_of(WORD) {
            let problem = format!("expected float32 numbers, but found {} bytes", bytes.len());
            return Err(FieldFault::new("attach", problem));
        }
        Ok(Self::Float32(attached.slice_ref(bytes)))
    }

    pub(super) fn len(&self) -> usize {
        match self {
            Self::List(_, range) => range.len(),
            Self::Float32(bytes) => bytes.len() / WORD,
        }
    }

    /// The `index`th of parts of `count` values each.
    pub(super) fn part(&self, index: usize, count: usize) -> Self {
        let start = index * count;
        match self {
            Self::List(values, range) => {
                let start = range.start + start;
                Self::List(Arc::clone(values), start..start + count)
            }
            Self::Float32(bytes) => {
                Self::Float32(bytes.slice(WORD * start..WORD * (start + count)))
            }
        }
    }

    pub(super) fn value(&self, index: usize) -> f64 {
        match self {
            Self::List(values, range) => values[range.clone()][index],
            Self::Float32(bytes) => f32::from_le_bytes(bytes.as_chunks().0[index]).into(),
        }
    }

    pub(super) fn values(&self) -> impl Iterator<Item = f64> {
        (0..self.len()).map(|index| self.value(index))
    }

    /// Memory of all values.
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::List(values, _) => size_of_val(values.as_slice()),
            // Those of the request, which are counted once.
            Self::Float32(_) => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::Attach;

    #[test]
    fn a_row_is_the_same_however_it_comes() {
        let numbers = [0.5, -1.25, 3.0, 4.0, 0.0, 1e-3_f32];
        let attached: Bytes = numbers.map(f32::to_le_bytes).concat().into();
        let attach = Attach {
            offset: 0,
            bytes: attached.len() as u64,
        };
        let list = DofValues::List(numbers.map(f64::from).to_vec());
        for given in [list, DofValues::Attached { attach }] {
            let row = DofRow::new(given, &attached).unwrap();
            assert_eq!(row.len(), 6);
            let part = row.part(1, 2);
            assert_eq!(part.values().collect::<Vec<f64>>(), [3.0, 4.0]);
            assert_eq!(part.part(1, 1).value(0), 4.0);
        }
    }

    #[test]
    fn attached_values_are_not_copied() {
        let attached = Bytes::from(vec![0; 16]);
        let attach = Attach {
            offset: 4,
            bytes: 8,
        };
        let row = DofRow::new(DofValues::Attached { attach }, &attached).unwrap();
        let DofRow::Float32(bytes) = row.part(1, 1) else {
            panic!("it came attached")
        };
        assert_eq!(bytes.as_ptr(), attached[8..].as_ptr());
    }
}

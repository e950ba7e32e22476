//! Rows of the sections of a `.skin`. Never lives here: whether what they name is there.

use crate::formats::cse169::sections::Section;
use crate::formats::error::{FileFault, LoadError};
use crate::formats::text::lexer::Lexer;
use crate::limits::Limits;
use crate::rig::LARGEST_COORDINATE;
use glam::{DAffine3, DVec3, Vec2, Vec3};

pub(super) fn vectors<'a>(
    section: &Section<'a>,
    lexer: &mut Lexer<'a>,
) -> Result<Vec<Vec3>, LoadError> {
    section.read_rows(lexer, 6, |lexer, row| {
        let numbers = lexer.numbers(|| section.in_row(row))?;
        Ok(DVec3::from_array(numbers).as_vec3())
    })
}

pub(super) fn texcoords<'a>(
    section: &Section<'a>,
    lexer: &mut Lexer<'a>,
) -> Result<Vec<Vec2>, LoadError> {
    section.read_rows(lexer, 4, |lexer, row| {
        let [u, v] = lexer.numbers(|| section.in_row(row))?;
        Ok(Vec2::new(u as f32, v as f32))
    })
}

pub(super) fn triangles<'a>(
    section: &Section<'a>,
    lexer: &mut Lexer<'a>,
) -> Result<Vec<[u32; 3]>, LoadError> {
    section.read_rows(lexer, 6, |lexer, row| {
        let mut triangle = [0; 3];
        for corner in &mut triangle {
            *corner = read_index(lexer, || section.in_row(row))?;
        }
        Ok(triangle)
    })
}

pub(super) fn bindings<'a>(
    section: &Section<'a>,
    lexer: &mut Lexer<'a>,
) -> Result<Vec<DAffine3>, LoadError> {
    section.read_rows(lexer, 31, |lexer, row| {
        let place = || section.in_row(row);
        let keyword = lexer.expect("matrix", place)?;
        lexer.expect("{", place)?;
        let numbers: [f64; 12] = lexer.numbers(place)?;
        lexer.expect("}", || format!("after 12 numbers {}", place()))?;
        let bind_from_joint = DAffine3::from_cols_array(&numbers);
        // As the rig will ask: an inverse beyond its numbers is rounding error.
        let inverse = bind_from_joint.inverse().to_cols_array();
        if !inverse
            .iter()
            .all(|entry| entry.abs() <= LARGEST_COORDINATE)
        {
            let expected = format!("a matrix that can be inverted {}", place());
            return Err(lexer
                .fault_found(keyword, expected, "one that cannot")
                .into());
        }
        Ok(bind_from_joint)
    })
}

pub(super) fn weights<'a>(
    section: &Section<'a>,
    lexer: &mut Lexer<'a>,
    influences: &mut Vec<(u32, f64)>,
    limits: &Limits,
) -> Result<Vec<u32>, LoadError> {
    section.read_rows(lexer, 2, |lexer, row| {
        let place = || section.in_row(row);
        let (count, count_token) = lexer.whole(place)?;
        limits.influences((influences.len() as u64).saturating_add(count))?;
        let Ok(count) = u32::try_from(count) else {
            let expected = format!("a number of influences below 2^32 {}", place());
            return Err(lexer.fault(count_token, expected).into());
        };
        for _ in 0..count {
            let joint = read_index(lexer, place)?;
            let start = lexer.offset();
            let weight = lexer.number(place)?;
            if weight < 0.0 {
                let token = lexer.from(start).next();
                let expected = format!("a weight that is not negative {}", place());
                return Err(lexer.fault(token, expected).into());
            }
            influences.push((joint, weight));
        }
        Ok(count)
    })
}

/// One that does not fit becomes the largest, which is out of every range.
fn read_index(lexer: &mut Lexer, place: impl Fn() -> String) -> Result<u32, FileFault> {
    let (index, _) = lexer.whole(place)?;
    Ok(u32::try_from(index).unwrap_or(u32::MAX))
}

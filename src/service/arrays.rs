//! Arrays of numbers as the wire has them: bytes, little-endian. Never lives here: how they travel.

use crate::frame::Pooled;
use bytemuck::Pod;
use bytes::Bytes;

/// Numbers of 4 bytes each, in the memory in which they are, which goes back to its pool once they are written.
pub(super) fn little_endian<T: Pod + Send>(numbers: impl Into<Pooled<Vec<T>>>) -> Bytes {
    let mut numbers = numbers.into();
    if cfg!(target_endian = "big") {
        for word in bytemuck::cast_slice_mut::<T, [u8; 4]>(&mut numbers) {
            word.reverse();
        }
    }
    Bytes::from_owner(numbers)
}

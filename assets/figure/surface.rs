//! The whole figure's surface: the modelled half, its mirror image and the weights of both.
//! No texture coordinates and no text.

use super::body::Body;
use super::relax::half_surface;
use super::vectors::V;
use super::weights::weights;

/// Both halves of the surface.  The left half comes first, vertices and faces.
pub struct Surface {
    pub points: Vec<V>,
    pub normals: Vec<V>,
    /// Influence of the table's bones, of the side that the vertex is on.
    pub weights: Vec<[f64; 15]>,
    pub right: Vec<bool>,
    pub faces: Vec<[usize; 3]>,
    /// How many of the faces are on the left; each has its mirror image as many further on.
    pub left_faces: usize,
    /// The vertex that each was mirrored from, itself for those of the left half.
    pub origin: Vec<usize>,
}

pub fn surface(body: &Body) -> Surface {
    let (half, half_normals) = half_surface(body);
    // The left half as it is, then the mirror images of all but the border.
    let mut points = half.points.clone();
    let mut normals = half_normals.clone();
    let mut influences: Vec<_> = half.points.iter().map(|&p| weights(body, p)).collect();
    let mut right = vec![false; points.len()];
    let mut origin: Vec<usize> = (0..points.len()).collect();
    let mut twin = origin.clone();
    for v in 0..half.points.len() {
        let flip = |a: V| [-a[0], a[1], a[2]];
        if half.points[v][0] != 0.0 {
            twin[v] = points.len();
            origin.push(v);
            points.push(flip(half.points[v]));
            normals.push(flip(half_normals[v]));
            influences.push(influences[v]);
            right.push(true);
        }
    }
    let mirrored = half
        .faces
        .iter()
        .map(|&[a, b, c]| [twin[a], twin[c], twin[b]]);
    let faces = half.faces.iter().copied().chain(mirrored).collect();
    Surface {
        points,
        normals,
        weights: influences,
        right,
        faces,
        left_faces: half.faces.len(),
        origin,
    }
}

//! Vectors and matrices of the oracle, by rows and written out. Never lives here: what a joint, a vertex or a file is.

pub type Vector = [f64; 3];
/// Rows of numbers; acts on column vectors.
pub type Square = [Vector; 3];
/// As [`Square`], affine: its last row is 0 0 0 1.
pub type Matrix = [[f64; 4]; 4];

pub fn from_columns([a, b, c, d]: [Vector; 4]) -> Matrix {
    let row = |i: usize| [a[i], b[i], c[i], d[i]];
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

pub fn translation([x, y, z]: Vector) -> Matrix {
    from_columns([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [x, y, z]])
}

/// What is left of an affine matrix without its translation.
pub fn linear_part(matrix: &Matrix) -> Square {
    [0, 1, 2].map(|i| [matrix[i][0], matrix[i][1], matrix[i][2]])
}

/// Where the matrix takes the origin.
pub fn origin(matrix: &Matrix) -> Vector {
    [0, 1, 2].map(|i| matrix[i][3])
}

pub fn affine(linear: &Square, at: Vector) -> Matrix {
    let column = |j: usize| [0, 1, 2].map(|i| linear[i][j]);
    from_columns([column(0), column(1), column(2), at])
}

/// About x, y or z (0, 1, 2), counterclockwise seen from where that axis points.
pub fn turn(axis: usize, angle: f64) -> Matrix {
    let (sin, cos) = angle.sin_cos();
    // About z these are x and y.
    let (from, to) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut matrix = translation([0.0; 3]);
    matrix[from][from] = cos;
    matrix[to][to] = cos;
    matrix[to][from] = sin;
    matrix[from][to] = -sin;
    matrix
}

pub fn product<const N: usize>(a: &[[f64; N]; N], b: &[[f64; N]; N]) -> [[f64; N]; N] {
    let mut c = [[0.0; N]; N];
    for (row, row_of_a) in c.iter_mut().zip(a) {
        for (column, entry) in row.iter_mut().enumerate() {
            *entry = (0..N).map(|k| row_of_a[k] * b[k][column]).sum();
        }
    }
    c
}

/// `sum += share · matrix`
pub fn add_share<const N: usize>(sum: &mut [[f64; N]; N], share: f64, matrix: &[[f64; N]; N]) {
    for (row, added) in sum.iter_mut().zip(matrix) {
        for (entry, added) in row.iter_mut().zip(added) {
            *entry += share * added;
        }
    }
}

pub fn moved(matrix: &Matrix, [x, y, z]: Vector) -> Vector {
    [0, 1, 2].map(|i| matrix[i][0] * x + matrix[i][1] * y + matrix[i][2] * z + matrix[i][3])
}

pub fn times(matrix: &Square, v: Vector) -> Vector {
    matrix.map(|row| dot(row, v))
}

pub fn transposed(matrix: &Square) -> Square {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| matrix[j][i]))
}

/// Minors with their signs: `cofactors · n` is the normal that `matrix` takes a surface's normal to.
pub fn cofactors(matrix: &Square) -> Square {
    let minor = |row: usize, column: usize| {
        let [r, s] = [(row + 1) % 3, (row + 2) % 3];
        let [c, d] = [(column + 1) % 3, (column + 2) % 3];
        matrix[r][c] * matrix[s][d] - matrix[r][d] * matrix[s][c]
    };
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| minor(row, column)))
}

/// The transpose of the inverse: cofactors by the determinant.
pub fn inverse_transposed(matrix: &Square) -> Square {
    let cofactor = cofactors(matrix);
    let determinant = dot(matrix[0], cofactor[0]);
    cofactor.map(|row| row.map(|entry| entry / determinant))
}

/// Of an affine matrix.
pub fn inverse(matrix: &Matrix) -> Matrix {
    let turned = transposed(&inverse_transposed(&linear_part(matrix)));
    let back = origin(matrix).map(|x| -x);
    product(&affine(&turned, [0.0; 3]), &translation(back))
}

pub fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    (0..N).map(|i| a[i] * b[i]).sum()
}

pub fn cross(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

pub fn length<const N: usize>(v: [f64; N]) -> f64 {
    dot(v, v).sqrt()
}

pub fn scaled(v: Vector) -> Vector {
    v.map(|x| x / length(v))
}

pub fn difference(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] - b[i])
}

/// `a + share · b`
pub fn along(a: Vector, share: f64, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] + share * b[i])
}

/// Of all entries together.
pub fn sum_of_squares(matrix: &Square) -> f64 {
    matrix.iter().map(|row| dot(*row, *row)).sum()
}

pub fn angle(a: Vector, b: Vector) -> f64 {
    // An arc cosine could not tell angles below 1e-8 apart, nor NaN from a right angle.
    length(cross(a, b)).atan2(dot(a, b))
}

//! Does a picture show what the contract in `render/plan.rs` says? By properties that follow from it.

mod support;

use rigd::service::Service;
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write;
use std::sync::{Arc, LazyLock};
use support::ask_ok;
use support::oracle::Vector;
use support::pictures::{Drawn, Image, ask_attached, attached_bytes, draw, encoded, linear, over};
use support::random::Random;

static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

/// Steps of 255 by which a color may be off its formula: half for rounding, and what a half-float and a coarse `pow` lose before that.
const EXACT: f64 = 0.75;

/// A surface of our own making, drawn as a rig that is only a skin.
#[derive(Clone, Default)]
struct Surface {
    positions: Vec<Vector>,
    normals: Vec<Vector>,
    triangles: Vec<[usize; 3]>,
}

impl Surface {
    /// A square in a plane of constant z, facing +Z, its side from `-half` to `half`.
    fn square(half: f64, z: f64) -> Self {
        let corner = |[x, y]: [f64; 2]| [half * x, half * y, z];
        Self {
            positions: [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(corner)
                .to_vec(),
            normals: vec![[0.0, 0.0, 1.0]; 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    /// The unit sphere, its triangles counter-clockwise.
    fn sphere(rings: usize, segments: usize) -> Self {
        let mut sphere = Self::default();
        for ring in 0..=rings {
            for segment in 0..=segments {
                let (down, around) = (
                    PI * ring as f64 / rings as f64,
                    TAU * segment as f64 / segments as f64,
                );
                let point = [
                    down.sin() * around.sin(),
                    down.cos(),
                    down.sin() * around.cos(),
                ];
                sphere.positions.push(point);
                if ring < rings && segment < segments {
                    let a = ring * (segments + 1) + segment;
                    let b = a + segments + 1;
                    sphere.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
                }
            }
        }
        sphere.normals = sphere.positions.clone();
        sphere
    }

    /// No plane, axis or point of symmetry is on one of the world's, so that nothing mirrored or swapped looks the same.
    fn egg() -> Self {
        let mut egg = Self::sphere(24, 48);
        for p in &mut egg.positions {
            let [x, y, z] = *p;
            *p = [
                x + 0.3 * y + 0.2,
                0.6 * y - 0.2 * z - 0.15,
                0.4 * z + 0.1 * x + 0.3,
            ];
        }
        egg
    }

    fn and(mut self, other: Self) -> Self {
        let first = self.positions.len();
        self.positions.extend(other.positions);
        self.normals.extend(other.normals);
        let moved = other
            .triangles
            .into_iter()
            .map(|t| t.map(|corner| first + corner));
        self.triangles.extend(moved);
        self
    }

    fn rewound(mut self) -> Self {
        self.triangles
            .iter_mut()
            .for_each(|triangle| triangle.swap(1, 2));
        self
    }

    fn with_normals_turned_over(mut self) -> Self {
        self.normals.iter_mut().for_each(|n| *n = n.map(|x| -x));
        self
    }

    fn text(&self) -> String {
        let mut text = String::new();
        for (section, vectors) in [("positions", &self.positions), ("normals", &self.normals)] {
            let _ = writeln!(text, "{section} {} {{", vectors.len());
            for [x, y, z] in vectors {
                let _ = writeln!(text, "{x:?} {y:?} {z:?}");
            }
            text.push_str("}\n");
        }
        let _ = writeln!(text, "triangles {} {{", self.triangles.len());
        for [a, b, c] in &self.triangles {
            let _ = writeln!(text, "{a} {b} {c}");
        }
        text.push_str("}\n");
        text
    }

    /// Its rig's name, which is `name`.
    fn load<'a>(&self, name: &'a str) -> &'a str {
        let files = json!([{"name": format!("{name}.skin"), "text": self.text()}]);
        ask_ok(&SERVICE, "rig.load", json!({"name": name, "files": files}));
        name
    }
}

fn load_skeleton<'a>(name: &'a str, text: &str) -> &'a str {
    let files = json!([{"name": format!("{name}.skel"), "text": text}]);
    ask_ok(&SERVICE, "rig.load", json!({"name": name, "files": files}));
    name
}

/// A white, matt surface in even white light before black, seen along −Z without perspective, 16 pixels a unit, the world's origin in
/// the middle of pixel (32, 32); then `changes` over it.
fn request(rig: &str, changes: Value) -> Value {
    let request = json!({
        "rig": rig,
        "size": [65, 65],
        "samples": 1,
        "camera": {"kind": "look_at", "eye": [0, 0, 5], "target": [0, 0, 0], "height": 65.0 / 16.0},
        "lights": [],
        "ambient": [1, 1, 1],
        "material": {"diffuse": [1, 1, 1], "specular": [0, 0, 0], "shininess": 1},
        "background": [0, 0, 0, 1],
    });
    over(request, changes)
}

fn picture(rig: &str, changes: Value) -> Image {
    draw(&SERVICE, &request(rig, changes)).image
}

#[track_caller]
fn assert_color(what: &str, found: [u8; 4], linear_rgb: [f64; 3], alpha: f64) {
    let wanted = [
        encoded(linear_rgb[0]),
        encoded(linear_rgb[1]),
        encoded(linear_rgb[2]),
        255.0 * alpha,
    ];
    let off = (0..4)
        .map(|i| (f64::from(found[i]) - wanted[i]).abs())
        .fold(0.0, f64::max);
    assert!(off <= EXACT, "{what}: {found:?}, wanted {wanted:.2?}");
}

const BLACK: [u8; 4] = [0, 0, 0, 255];

// Background

#[test]
fn the_background_is_the_color_asked_for() {
    for background in [
        [0.0, 0.0, 0.0, 1.0],
        [1.0, 1.0, 1.0, 1.0],
        [0.2, 0.5, 0.8, 1.0],
        [0.002, 0.0031, 0.0032, 1.0],
        [0.2, 0.5, 0.8, 0.5],
        [1.0, 0.01, 0.3, 0.1],
        [0.2, 0.5, 0.8, 0.0],
    ] {
        let [r, g, b, alpha] = background;
        let hidden = json!({"background": background, "show": {"skin": "none"}, "samples": 4, "size": [70, 33]});
        // What is not there at all has no color.
        let wanted = if alpha == 0.0 { [0.0; 3] } else { [r, g, b] };
        for (_, _, pixel) in picture("figure", hidden).iter() {
            assert_color(&format!("{background:?}"), pixel, wanted, alpha);
        }
    }
}

#[test]
fn png_and_bare_pixels_are_the_same_picture() {
    let wanted = picture(
        "figure",
        json!({"background": [0.2, 0.1, 0.0, 0.3], "samples": 4}),
    );
    for compression in ["fast", "default", "best"] {
        let mut request = request(
            "figure",
            json!({"background": [0.2, 0.1, 0.0, 0.3], "samples": 4}),
        );
        request["image"] = json!("png");
        request["transport"] = json!("attach");
        request["compression"] = json!(compression);
        let (frame, attached) = ask_attached(&SERVICE, "frame.render", &request);
        let file = attached_bytes(&frame["images"]["color"], &attached);
        assert_eq!(Image::from_png(file), wanted, "{compression}");
    }
}

// Projection

/// A camera, its picture's size, and where it puts a point by its own formula, where that is short enough to write down.
struct Camera {
    name: &'static str,
    fields: Value,
    size: [usize; 2],
    is_orthographic: bool,
    formula: Option<fn(Vector) -> [f64; 2]>,
}

fn cameras() -> Vec<Camera> {
    let camera = |name, fields, size, formula| Camera {
        name,
        is_orthographic: name == "orthographic",
        fields,
        size,
        formula,
    };
    let from_side = json!([0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 6, 0, 0, 1]);
    let from_behind = json!([-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, -6, 1]);
    vec![
        camera(
            "orbit",
            json!({"kind": "orbit", "target": [0.2, 0, 0], "distance": 6, "azimuth": FRAC_PI_2, "inclination": 0, "fov_y": 0.6}),
            [128, 128],
            Some(|[x, y, z]| {
                let scale = 64.0 / 0.3f64.tan() / (6.2 - x);
                [64.0 - scale * z, 64.0 - scale * y]
            }),
        ),
        camera(
            "orbit from above",
            json!({"kind": "orbit", "target": [0.1, 0.1, 0], "distance": 7, "azimuth": 0.6, "inclination": 0.5, "fov_y": 0.5}),
            [200, 100],
            None,
        ),
        camera(
            "look_at",
            json!({"kind": "look_at", "eye": [0, 0, 8], "target": [0, 0, 0], "fov_y": 0.8}),
            [100, 200],
            Some(|[x, y, z]| {
                let scale = 100.0 / 0.4f64.tan() / (8.0 - z);
                [50.0 + scale * x, 100.0 - scale * y]
            }),
        ),
        camera(
            "look_at askew",
            json!({"kind": "look_at", "eye": [3, 2, -4], "target": [0.2, 0, 0.3], "up": [0.3, 1, 0], "fov_y": 0.6}),
            [160, 120],
            None,
        ),
        camera(
            "orthographic",
            json!({"kind": "look_at", "eye": [0, 0, 5], "target": [0, 0, 0], "height": 3}),
            [200, 100],
            Some(|[x, y, _]| [100.0 + x * 100.0 / 3.0, 50.0 - y * 100.0 / 3.0]),
        ),
        camera(
            "pinhole gl",
            json!({"kind": "pinhole", "fx": 200, "fy": 260, "cx": 40, "cy": 90, "world_from_camera": from_side}),
            [120, 140],
            Some(|[x, y, z]| [40.0 - 200.0 * z / (6.0 - x), 90.0 - 260.0 * y / (6.0 - x)]),
        ),
        camera(
            "pinhole cv",
            json!({"kind": "pinhole", "fx": 220, "fy": 180, "cx": 75, "cy": 45, "axes": "cv", "world_from_camera": from_behind}),
            [130, 110],
            Some(|[x, y, z]| [75.0 - 220.0 * x / (6.0 + z), 45.0 - 180.0 * y / (6.0 + z)]),
        ),
    ]
}

fn drawn_by(camera: &Camera, rig: &str) -> Drawn {
    let changes = json!({"camera": camera.fields, "size": camera.size});
    draw(&SERVICE, &request(rig, changes))
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[test]
fn a_silhouette_lies_where_the_vertices_are_projected_to() {
    let egg = Surface::egg();
    let rig = egg.load("egg");
    for camera in cameras() {
        let drawn = drawn_by(&camera, rig);
        let mut seen = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for (x, y, _) in drawn.image.iter().filter(|(_, _, pixel)| *pixel != BLACK) {
            seen = grown(seen, [x as f64, y as f64]);
            seen = grown(seen, [x as f64 + 1.0, y as f64 + 1.0]);
        }
        let outside = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        let projected = egg
            .positions
            .iter()
            .fold(outside, |box_, &p| grown(box_, drawn.pixel_by_clip(p)));
        // A pixel is drawn where its middle is covered, so an edge is found to within half a pixel; a rounded one to within one.
        for corner in 0..2 {
            for axis in 0..2 {
                let (seen, projected) = (seen[corner][axis], projected[corner][axis]);
                assert!(
                    (seen - projected).abs() <= 1.0,
                    "{}: {seen} and {projected}",
                    camera.name
                );
            }
        }
        let [width, height] = camera.size.map(|side| side as f64);
        let inside = projected[0].iter().all(|x| *x > 1.0)
            && projected[1][0] < width
            && projected[1][1] < height;
        assert!(
            inside,
            "{}: the egg is wholly in the picture, or its box proves nothing",
            camera.name
        );
    }
}

fn grown([min, max]: [[f64; 2]; 2], [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
    [
        [min[0].min(x), min[1].min(y)],
        [max[0].max(x), max[1].max(y)],
    ]
}

#[test]
fn the_cameras_of_a_reply_agree_with_each_other_and_with_the_request() {
    let rig = Surface::egg().load("egg");
    let mut random = Random(7);
    for camera in cameras() {
        let drawn = drawn_by(&camera, rig);
        for _ in 0..20 {
            let point = [0; 3].map(|_| random.within(1.0));
            let by_clip = drawn.pixel_by_clip(point);
            let by_intrinsics = drawn.pixel_by_intrinsics(point, camera.is_orthographic);
            assert!(
                distance(by_clip, by_intrinsics) < 1e-9,
                "{}: {by_clip:?} {by_intrinsics:?}",
                camera.name
            );
            if let Some(formula) = camera.formula {
                let wanted = formula(point);
                assert!(
                    distance(by_clip, wanted) < 1e-9,
                    "{}: {by_clip:?}, wanted {wanted:?}",
                    camera.name
                );
            }
        }
    }
}

#[test]
fn a_turned_camera_moves_what_it_sees_the_other_way() {
    // A small square one unit to the right of what the camera looks at; turning the eye from +Z toward +X swings it toward the middle.
    let rig = Surface::square(0.2, 0.0).load("small square");
    for azimuth in [0.0f64, 0.5, 1.2] {
        let camera = json!({"kind": "orbit", "target": [-1, 0, 0], "distance": 6, "azimuth": azimuth, "inclination": 0, "fov_y": 0.8});
        let image = picture(rig, json!({"camera": camera, "size": [128, 128]}));
        let columns: Vec<usize> = image
            .iter()
            .filter(|it| it.2 != BLACK)
            .map(|it| it.0)
            .collect();
        let found = columns.iter().sum::<usize>() as f64 / columns.len() as f64 + 0.5;
        let wanted = 64.0 + 64.0 / 0.4f64.tan() * azimuth.cos() / (6.0 - azimuth.sin());
        assert!(
            (found - wanted).abs() < 1.0,
            "{azimuth}: {found}, wanted {wanted}"
        );
    }
}

// Light

/// A light as a request has it, and as a point is lit by it.
#[derive(Clone, Copy)]
enum Lamp {
    Directional {
        direction: Vector,
        color: Vector,
        intensity: f64,
    },
    Point {
        position: Vector,
        color: Vector,
        intensity: f64,
        is_inverse_square: bool,
    },
}

impl Lamp {
    fn wire(&self) -> Value {
        match self {
            Self::Directional {
                direction,
                color,
                intensity,
            } => {
                json!({"kind": "directional", "direction": direction, "color": color, "intensity": intensity})
            }
            Self::Point {
                position,
                color,
                intensity,
                is_inverse_square,
            } => {
                let falloff = if *is_inverse_square {
                    "inverse_square"
                } else {
                    "none"
                };
                json!({"kind": "point", "position": position, "color": color, "intensity": intensity, "falloff": falloff})
            }
        }
    }

    /// Unit vector toward the light, and its radiance there.
    fn at(&self, p: Vector) -> (Vector, Vector) {
        match *self {
            Self::Directional {
                direction,
                color,
                intensity,
            } => (unit(direction.map(|x| -x)), color.map(|c| c * intensity)),
            Self::Point {
                position,
                color,
                intensity,
                is_inverse_square,
            } => {
                let toward = [0, 1, 2].map(|i| position[i] - p[i]);
                let falloff = if is_inverse_square {
                    dot(toward, toward)
                } else {
                    1.0
                };
                (unit(toward), color.map(|c| c * intensity / falloff))
            }
        }
    }
}

fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn unit(v: Vector) -> Vector {
    v.map(|x| x / dot(v, v).sqrt())
}

const AMBIENT: Vector = [0.05, 0.04, 0.06];
const DIFFUSE: Vector = [0.5, 0.4, 0.3];
const SPECULAR: Vector = [0.3, 0.25, 0.35];
const SHININESS: f64 = 30.0;

/// The equation of the contract, in f64.
fn lit(p: Vector, n: Vector, back_to_eye: Vector, lamps: &[Lamp]) -> Vector {
    let mut color = [0, 1, 2].map(|i| AMBIENT[i] * DIFFUSE[i]);
    for lamp in lamps {
        let (l, radiance) = lamp.at(p);
        let n_dot_l = dot(n, l);
        if n_dot_l > 0.0 {
            let h = unit([0, 1, 2].map(|i| l[i] + back_to_eye[i]));
            let highlight = dot(n, h).max(0.0).powf(SHININESS);
            for i in 0..3 {
                color[i] += radiance[i] * (DIFFUSE[i] * n_dot_l + SPECULAR[i] * highlight);
            }
        }
    }
    color.map(|c| c.clamp(0.0, 1.0))
}

fn lamps() -> Vec<(&'static str, Vec<Lamp>)> {
    let warm = Lamp::Directional {
        direction: [-1.0, -0.8, -1.2],
        color: [1.0, 0.9, 0.7],
        intensity: 0.9,
    };
    let cold = Lamp::Directional {
        direction: [1.0, 0.2, -0.3],
        color: [0.3, 0.5, 1.0],
        intensity: 0.8,
    };
    let near = |is_inverse_square| Lamp::Point {
        position: [1.2, 1.5, 2.0],
        color: [0.8, 1.0, 0.9],
        intensity: if is_inverse_square { 4.0 } else { 1.0 },
        is_inverse_square,
    };
    vec![
        ("none", vec![]),
        ("directional", vec![warm]),
        ("two directional", vec![warm, cold]),
        ("point", vec![near(false)]),
        ("point, inverse square", vec![near(true)]),
        ("all", vec![cold, near(true)]),
    ]
}

/// Where the line of sight through a pixel's middle meets the unit sphere, and the direction back along it.
type Seen = fn(f64, f64) -> Option<(Vector, Vector)>;

fn seen_without_perspective(x: f64, y: f64) -> Option<(Vector, Vector)> {
    let [x, y] = [(x - 50.5) / 40.0, (50.5 - y) / 40.0];
    let z = (1.0 - x * x - y * y).sqrt();
    (!z.is_nan()).then_some(([x, y, z], [0.0, 0.0, 1.0]))
}

fn seen_from_three_units(x: f64, y: f64) -> Option<(Vector, Vector)> {
    let direction = unit([(x - 50.5) / 100.0, (50.5 - y) / 100.0, -1.0]);
    let eye = [0.0, 0.0, 3.0];
    let along = -dot(eye, direction);
    let distance = along - (along * along - 8.0).sqrt();
    let p = [0, 1, 2].map(|i| eye[i] + distance * direction[i]);
    (!distance.is_nan()).then_some((p, direction.map(|x| -x)))
}

/// Steps of 255 that a sphere of flat triangles may be off from a round one, in its color.
const ROUND: f64 = 2.0;

#[test]
fn every_pixel_of_a_sphere_is_lit_by_the_equation() {
    let rig = Surface::sphere(64, 128).load("round sphere");
    let orthographic =
        json!({"kind": "look_at", "eye": [0, 0, 3], "target": [0, 0, 0], "height": 101.0 / 40.0});
    let pinhole = json!({"kind": "pinhole", "fx": 100, "fy": 100, "cx": 50.5, "cy": 50.5,
        "world_from_camera": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 3, 1]});
    let cameras: [(Value, Seen); 2] = [
        (orthographic, seen_without_perspective),
        (pinhole, seen_from_three_units),
    ];
    for ((name, lamps), (camera, seen)) in lamps()
        .iter()
        .flat_map(|l| cameras.iter().map(move |c| (l, c)))
    {
        let image = picture(
            rig,
            json!({
                "size": [101, 101], "camera": camera, "ambient": AMBIENT,
                "lights": lamps.iter().map(Lamp::wire).collect::<Vec<_>>(),
                "material": {"diffuse": DIFFUSE, "specular": SPECULAR, "shininess": SHININESS},
            }),
        );
        let mut compared = 0;
        for (x, y, pixel) in image.iter() {
            let Some((p, back)) = seen(x as f64 + 0.5, y as f64 + 0.5) else {
                continue;
            };
            // Toward the rim a triangle's flatness moves a point of it by more than a pixel can hide.
            if dot(p, back) < 0.35 {
                continue;
            }
            let wanted = lit(p, p, back, lamps).map(encoded);
            let off = (0..3)
                .map(|i| (f64::from(pixel[i]) - wanted[i]).abs())
                .fold(0.0, f64::max);
            assert!(
                off <= ROUND,
                "{name} at {x},{y}: {pixel:?}, wanted {wanted:.1?}"
            );
            compared += 1;
        }
        assert!(compared > 3000, "{compared}");
    }
}

#[test]
fn a_highlight_lies_where_the_halfway_vector_is_the_normal() {
    let rig = Surface::sphere(64, 128).load("round sphere");
    for [x, y, z] in [[1.0, 0.5, 1.0], [-0.7, 0.9, 0.4], [0.2, -0.8, 1.5]] {
        let image = picture(
            rig,
            json!({
                "size": [101, 101], "ambient": [0, 0, 0],
                "camera": {"kind": "look_at", "eye": [0, 0, 3], "target": [0, 0, 0], "height": 101.0 / 40.0},
                "lights": [{"kind": "directional", "direction": [-x, -y, -z], "intensity": 0.9}],
                "material": {"diffuse": [0, 0, 0], "specular": [1, 1, 1], "shininess": 300},
            }),
        );
        let brightest = image.iter().map(|it| it.2[0]).max().unwrap_or(0);
        let spot: Vec<_> = image
            .iter()
            .filter(|it| linear(it.2[0]) > 0.8 * linear(brightest))
            .collect();
        let sum = spot.iter().fold([0.0; 2], |sum, it| {
            [sum[0] + it.0 as f64 + 0.5, sum[1] + it.1 as f64 + 0.5]
        });
        let found = sum.map(|sum| sum / spot.len() as f64);
        let l = unit([x, y, z]);
        let h = unit([l[0], l[1], l[2] + 1.0]);
        let wanted = [50.5 + 40.0 * h[0], 50.5 - 40.0 * h[1]];
        assert!(
            distance(found, wanted) < 1.0,
            "{found:?}, wanted {wanted:?}"
        );
    }
}

#[test]
fn lights_of_two_colors_show_on_two_sides() {
    let rig = Surface::sphere(24, 48).load("sphere");
    let image = picture(
        rig,
        json!({
            "ambient": [0, 0, 0],
            "lights": [
                {"kind": "directional", "direction": [-1, 0, 0], "color": [1, 0, 0]},
                {"kind": "point", "position": [-50, 0, 0], "color": [0, 0, 1]},
            ],
        }),
    );
    let mut lit = [0, 0];
    for (x, _, [red, green, blue, _]) in image.iter().filter(|it| it.0 != 32) {
        let is_right = x > 32;
        assert!(
            green == 0 && (red == 0 || is_right) && (blue == 0 || !is_right),
            "column {x}"
        );
        lit[usize::from(is_right)] += usize::from(red > 0 || blue > 0);
    }
    assert!(lit.iter().all(|lit| *lit > 300), "{lit:?}");
}

#[test]
fn a_matt_wall_has_the_color_of_its_light() {
    let rig = Surface::square(4.0, 0.0).load("wall");
    let straight = |intensity: f64| json!([{"kind": "directional", "direction": [0, 0, -3], "intensity": intensity, "color": [1, 0.8, 0.6]}]);
    let slanting = json!([{"kind": "directional", "direction": [3f64.sqrt(), 0, -1]}]);
    let both = json!([straight(0.5)[0], slanting[0]]);
    let sixteen: Vec<Value> = (1..=16).map(|i| json!({"kind": "directional", "direction": [0, 0, -1], "intensity": f64::from(i) / 200.0})).collect();
    for (name, lights, ambient, light) in [
        (
            "ambient light alone",
            json!([]),
            [0.3, 0.6, 0.9],
            [0.3, 0.6, 0.9],
        ),
        ("straight", straight(1.0), [0.0; 3], [1.0, 0.8, 0.6]),
        ("half as strong", straight(0.5), [0.0; 3], [0.5, 0.4, 0.3]),
        ("too strong", straight(9.0), [0.0; 3], [9.0, 7.2, 5.4]),
        ("at 60 degrees", slanting.clone(), [0.0; 3], [0.5; 3]),
        ("the sum", both, [0.1; 3], [1.1, 1.0, 0.9]),
        ("sixteen", json!(sixteen), [0.0; 3], [0.68; 3]),
    ] {
        for diffuse in [[1.0, 1.0, 1.0], [0.2, 0.5, 0.8], [0.01, 0.002, 0.0]] {
            let image = picture(
                rig,
                json!({
                    "lights": lights, "ambient": ambient,
                    "material": {"diffuse": diffuse, "specular": [0, 0, 0]},
                }),
            );
            let wanted = [0, 1, 2].map(|i| diffuse[i] * light[i]);
            for (_, _, pixel) in image.iter() {
                assert_color(name, pixel, wanted, 1.0);
            }
        }
    }
}

#[test]
fn a_light_that_weakens_halves_at_root_two_times_the_distance() {
    let rig = Surface::square(4.0, 0.0).load("wall");
    let at = |distance: f64, intensity: f64, falloff: &str| {
        picture(rig, json!({
            "ambient": [0, 0, 0],
            "lights": [{"kind": "point", "position": [0, 0, distance], "intensity": intensity, "falloff": falloff}],
        }))
        .center()
    };
    let root = 2f64.sqrt();
    for (distance, intensity, falloff, wanted) in [
        (1.0, 0.8, "inverse_square", 0.8),
        (root, 0.8, "inverse_square", 0.4),
        (2.0, 0.8, "inverse_square", 0.2),
        (2.0, 0.8, "none", 0.8),
        (20.0, 80.0, "inverse_square", 0.2),
        // The wall's size squared is 128, so nothing counts as nearer than the root of 1.28e-2.
        (0.01, 6.4e-3, "inverse_square", 0.5),
        (0.05, 6.4e-3, "inverse_square", 0.5),
    ] {
        let found = at(distance, intensity, falloff);
        assert_color(
            &format!("{intensity} at {distance}, {falloff}"),
            found,
            [wanted; 3],
            1.0,
        );
    }
    assert!(
        (linear(at(root, 0.8, "inverse_square")[0]) * 2.0
            - linear(at(1.0, 0.8, "inverse_square")[0]))
        .abs()
            < 0.01
    );
}

#[test]
fn a_surface_gleams_only_where_light_falls_on_it() {
    let rig = Surface::square(4.0, 0.0).load("wall");
    for (name, light_z, is_lit) in [("from before", 0.05, true), ("from behind", -0.05, false)] {
        // Either way the halfway vector is within 45 degrees of the normal.
        let l = unit([1.0, 0.0, light_z]);
        let found = picture(
            rig,
            json!({
                "ambient": [0, 0, 0],
                "lights": [{"kind": "directional", "direction": l.map(|x| -x)}],
                "material": {"diffuse": [0, 0, 0], "specular": [1, 1, 1], "shininess": 2},
            }),
        );
        let n_dot_h = unit([l[0], l[1], l[2] + 1.0])[2];
        let wanted = if is_lit { n_dot_h * n_dot_h } else { 0.0 };
        assert_color(name, found.center(), [wanted; 3], 1.0);
    }
}

#[test]
fn an_exponent_of_zero_gleams_everywhere_and_a_large_one_in_one_place() {
    let rig = Surface::square(4.0, 0.0).load("wall");
    let gleam = |shininess: f64| {
        picture(
            rig,
            json!({
                "ambient": [0, 0, 0], "size": [65, 65],
                "camera": {"kind": "look_at", "eye": [0, 0, 3], "target": [0, 0, 0], "fov_y": 1},
                "lights": [{"kind": "directional", "direction": [0, 0, -1], "intensity": 0.5}],
                "material": {"diffuse": [0, 0, 0], "specular": [1, 1, 1], "shininess": shininess},
            }),
        )
    };
    assert!(gleam(0.0).iter().all(|it| it.2 == gleam(0.0).center()));
    assert_color("exponent 0", gleam(0.0).center(), [0.5; 3], 1.0);
    let sharp = gleam(10_000.0);
    assert_color("exponent 10000", sharp.center(), [0.5; 3], 1.0);
    assert_eq!(sharp.at(0, 0), BLACK);
}

#[test]
fn light_from_behind_stays_behind() {
    // Past the silhouette there are only normals that turn away from the eye; a pixel on the edge must not be lit by one.
    for (name, rings, segments) in [("sphere", 24, 48), ("round sphere", 64, 128)] {
        let rig = Surface::sphere(rings, segments).load(name);
        let [azimuth, inclination] = [0.3f64, 0.4];
        let toward_eye = [
            azimuth.sin() * inclination.cos(),
            inclination.sin(),
            azimuth.cos() * inclination.cos(),
        ];
        let image = picture(
            rig,
            json!({
                "samples": 4, "background": [0, 0, 0, 0], "ambient": [0, 0, 0],
                "camera": {"kind": "orbit", "target": [0, 0, 0], "distance": 6, "azimuth": azimuth, "inclination": inclination, "fov_y": 0.4},
                "lights": [{"kind": "directional", "direction": toward_eye}],
            }),
        );
        for (x, y, pixel) in image.iter() {
            assert!(linear(pixel[0]) < 0.05, "{name} at {x},{y}: {pixel:?}");
        }
    }
}

#[test]
fn nothing_is_darker_than_its_ambient_light() {
    // A number that is none is drawn as black, so what is black here is a fault in the arithmetic.
    let (sphere, wall) = (
        Surface::sphere(24, 48).load("sphere"),
        Surface::square(1.0, 0.0).load("thin wall"),
    );
    let before = json!({"kind": "look_at", "eye": [0, 0, 5], "target": [0, 0, 0], "fov_y": 0.5});
    let edge_on =
        json!({"kind": "look_at", "eye": [3, 0, 0.05], "target": [0, 0, 0], "fov_y": 0.5});
    let lights = [
        (
            "grazing",
            json!({"kind": "directional", "direction": [-1, 0, -1e-7]}),
        ),
        (
            "toward the eye",
            json!({"kind": "directional", "direction": [0, 0, 1]}),
        ),
        (
            "along the wall, toward the eye",
            json!({"kind": "directional", "direction": [1, 0, 0]}),
        ),
        (
            "on the surface",
            json!({"kind": "point", "position": [0, 0, 1], "falloff": "inverse_square"}),
        ),
        (
            "on a vertex",
            json!({"kind": "point", "position": [0, 1, 0], "falloff": "inverse_square", "intensity": 1e12}),
        ),
        (
            "in the middle",
            json!({"kind": "point", "position": [0, 0, 0], "falloff": "inverse_square"}),
        ),
        (
            "at the eye",
            json!({"kind": "point", "position": [3, 0, 0.05], "intensity": 1e12}),
        ),
        (
            "far away",
            json!({"kind": "point", "position": [1e12, 1e12, 0], "falloff": "inverse_square", "intensity": 1e12}),
        ),
    ];
    for ((rig, camera), normals) in [
        (sphere, &before),
        (sphere, &edge_on),
        (wall, &before),
        (wall, &edge_on),
    ]
    .into_iter()
    .flat_map(|it| ["smooth", "flat"].map(|normals| (it, normals)))
    {
        let base = json!({"camera": camera, "samples": 4, "ambient": [0.2, 0.2, 0.2], "background": [1, 1, 1, 1], "show": {"normals": normals}});
        let dim = picture(rig, base.clone());
        assert!(
            dim.iter().any(|it| it.2 != [255; 4]),
            "the surface is in the picture"
        );
        for (name, light) in &lights {
            for shininess in [0, 1, 10_000] {
                let mut changes = base.clone();
                changes["lights"] = json!([light]);
                changes["material"] =
                    json!({"diffuse": [1, 1, 1], "specular": [1, 1, 1], "shininess": shininess});
                let image = picture(rig, changes);
                for (x, y, pixel) in image.iter() {
                    let least = dim.at(x, y);
                    assert!(
                        (0..3).all(|i| pixel[i] >= least[i]),
                        "{rig}, {normals}, light {name}, exponent {shininess}, at {x},{y}: {pixel:?} under {least:?}"
                    );
                }
            }
        }
    }
}

// Surfaces

#[test]
fn winding_and_turned_normals_change_nothing() {
    let egg = Surface::egg();
    let lights = json!([{"kind": "directional", "direction": [-1, -1, -1], "intensity": 0.7}, {"kind": "point", "position": [-3, 1, 2], "color": [0.2, 0.4, 1]}]);
    let changes = json!({
        "lights": lights, "ambient": [0.1, 0.1, 0.1], "samples": 4,
        "material": {"diffuse": [0.7, 0.7, 0.7], "specular": [0.3, 0.3, 0.3], "shininess": 20},
    });
    let wanted = picture(egg.load("egg"), changes.clone());
    for (name, variant) in [
        ("egg rewound", egg.clone().rewound()),
        ("egg inside out", egg.clone().with_normals_turned_over()),
        (
            "egg inside out, rewound",
            egg.clone().rewound().with_normals_turned_over(),
        ),
    ] {
        let found = picture(variant.load(name), changes.clone());
        // The corners of a triangle in another order are interpolated with other rounding.
        assert!(
            found.worst_difference(&wanted) <= 1,
            "{name}: {}",
            found.worst_difference(&wanted)
        );
    }
}

#[test]
fn both_sides_of_a_wall_are_lit_alike() {
    let rig = Surface::square(1.5, 0.0).load("two-sided wall");
    let seen_from = |side: f64| {
        picture(
            rig,
            json!({
                "camera": {"kind": "look_at", "eye": [0, 0, 5.0 * side], "target": [0, 0, 0], "fov_y": 0.6},
                "lights": [{"kind": "directional", "direction": [0, -0.5, -side], "intensity": 0.8}],
                "ambient": [0.1, 0.1, 0.1],
            }),
        )
    };
    let (front, back) = (seen_from(1.0), seen_from(-1.0));
    assert_eq!(front.worst_difference(&back), 0);
    assert!(front.center()[0] > encoded(0.5) as u8);
}

#[test]
fn flat_normals_light_each_facet_evenly() {
    // A pyramid seen from its tip: which facet a pixel shows is told by which coordinate is larger, and with which sign.
    let (tip, half) = ([0.0, 0.0, 1.0], 1.5);
    let base = Surface::square(half, 0.0);
    let pyramid = Surface {
        positions: [vec![tip], base.positions].concat(),
        normals: vec![[0.0, 0.0, 1.0]; 5],
        triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]],
    };
    let rig = pyramid.load("pyramid");
    let l = unit([0.5, 0.3, 0.8]);
    let image_of = |normals: &str| {
        picture(
            rig,
            json!({
                "ambient": [0.1, 0.1, 0.1], "show": {"normals": normals},
                "lights": [{"kind": "directional", "direction": l.map(|x| -x), "intensity": 0.8}],
            }),
        )
    };
    let (flat, smooth) = (image_of("flat"), image_of("smooth"));
    let mut seen = [0; 4];
    for (x, y, pixel) in flat.iter() {
        let [x, y] = [
            (x as f64 + 0.5 - 32.5) / 16.0,
            (32.5 - y as f64 - 0.5) / 16.0,
        ];
        if (x.abs() - y.abs()).abs() < 0.1 || x.abs().max(y.abs()) > half - 0.1 {
            continue;
        }
        let facet = if x.abs() > y.abs() {
            [x.signum(), 0.0]
        } else {
            [0.0, y.signum()]
        };
        let n = unit([facet[0], facet[1], half]);
        assert_color("a facet", pixel, [0.1 + 0.8 * dot(n, l).max(0.0); 3], 1.0);
        seen[usize::from(x.abs() > y.abs()) + 2 * usize::from(x + y > 0.0)] += 1;
    }
    assert!(seen.iter().all(|count| *count > 100), "{seen:?}");
    // All vertices have the same normal, so smooth light tells no facet from another.
    assert_color("smooth", smooth.at(32, 20), [0.1 + 0.8 * l[2]; 3], 1.0);
    assert_color("smooth", smooth.at(20, 32), [0.1 + 0.8 * l[2]; 3], 1.0);
}

#[test]
fn a_translucent_skin_is_mixed_in_linear_light_with_what_is_behind_it() {
    let rig = Surface::square(4.0, 0.0).load("wall");
    let skin = [0.8, 0.4, 0.1];
    for (opacity, background) in [
        (0.5, [0.1, 0.2, 0.9, 1.0]),
        (0.25, [1.0, 0.5, 0.0, 1.0]),
        (0.5, [0.1, 0.2, 0.9, 0.5]),
        (0.75, [0.0, 0.0, 0.0, 0.0]),
        (0.0, [0.1, 0.2, 0.9, 1.0]),
        (1.0, [0.1, 0.2, 0.9, 0.5]),
    ] {
        for samples in [1, 4] {
            let image = picture(
                rig,
                json!({
                    "background": background, "samples": samples, "show": {"skin_opacity": opacity},
                    "material": {"diffuse": skin, "specular": [0, 0, 0]},
                }),
            );
            let behind = background[3] * (1.0 - opacity);
            let alpha = opacity + behind;
            let wanted = [0, 1, 2].map(|i| (skin[i] * opacity + background[i] * behind) / alpha);
            assert_color(
                &format!("{opacity} over {background:?}"),
                image.center(),
                wanted,
                alpha,
            );
        }
    }
}

#[test]
fn of_a_translucent_skin_only_the_nearest_surface_shows() {
    // Lit by its distance from the camera, so that the two walls have different colors.
    let (near, far) = (Surface::square(4.0, 1.0), Surface::square(4.0, -1.0));
    let light = json!([{"kind": "point", "position": [0, 0, 2], "falloff": "inverse_square", "intensity": 0.6}]);
    for (name, walls) in [
        ("near first", near.clone().and(far.clone())),
        ("far first", far.and(near)),
    ] {
        let image = picture(
            walls.load(name),
            json!({
                "lights": light, "ambient": [0, 0, 0], "background": [0.3, 0.3, 0.3, 1], "show": {"skin_opacity": 0.5},
            }),
        );
        assert_color(name, image.center(), [0.5 * 0.6 + 0.5 * 0.3; 3], 1.0);
    }
}

#[test]
fn more_samples_soften_edges_and_leave_the_inside_alone() {
    let mut square = Surface::square(1.0, 0.0);
    // Turned this way no two samples lie one behind the other along an edge.
    let (sin, cos) = (-0.15f64).sin_cos();
    for p in &mut square.positions {
        *p = [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1], 0.0];
    }
    let rig = square.load("tilted square");
    let [one, four] = [1, 4].map(|samples| picture(rig, json!({"samples": samples})));
    let mut softened = 0;
    for (x, y, pixel) in four.iter() {
        let neighbours = |image: &Image| -> Vec<[u8; 4]> {
            let near = |at: usize| at.saturating_sub(1)..=(at + 1).min(64);
            near(y)
                .flat_map(|y| near(x).map(move |x| (x, y)))
                .map(|(x, y)| image.at(x, y))
                .collect()
        };
        let around = neighbours(&one);
        if around.iter().all(|it| *it == around[0]) {
            assert_eq!(pixel, around[0], "at {x},{y}");
        } else {
            softened += usize::from(pixel != [255; 4] && pixel != BLACK);
        }
    }
    // Four sides of 32 pixels.
    assert!(softened > 60, "{softened}");
    assert!(one.iter().all(|it| it.2 == [255; 4] || it.2 == BLACK));
    // Of four samples there are three mixtures.
    let mut mixtures: Vec<u8> = four.iter().map(|it| it.2[0]).collect();
    mixtures.sort_unstable();
    mixtures.dedup();
    let wanted = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| encoded(share).round() as u8);
    assert_eq!(mixtures, wanted);
}

#[test]
fn edges_before_nothing_keep_the_color_of_the_surface() {
    let rig = Surface::sphere(24, 48).load("sphere");
    let image = picture(
        rig,
        json!({
            "samples": 4, "background": [0, 0, 0, 0], "material": {"diffuse": [0.8, 0.4, 0.1], "specular": [0, 0, 0]},
        }),
    );
    let edge: Vec<_> = image
        .iter()
        .filter(|it| (1..255).contains(&it.2[3]))
        .collect();
    assert!(edge.len() > 50);
    for (_, _, pixel) in edge {
        let alpha = (f64::from(pixel[3]) / 255.0 * 4.0).round() / 4.0;
        assert_color("an edge", pixel, [0.8, 0.4, 0.1], alpha);
    }
}

#[test]
fn what_is_nearer_hides_what_is_behind_it() {
    let half = Surface::square(1.0, 1.0);
    let wall = Surface::square(2.0, -1.0);
    let light = json!([{"kind": "point", "position": [0, 0, 3], "falloff": "inverse_square", "intensity": 2}]);
    for (name, both) in [
        ("nearer first", half.clone().and(wall.clone())),
        ("nearer last", wall.clone().and(half.clone())),
    ] {
        for eye in [5.0, 500.0] {
            let camera = json!({"kind": "look_at", "eye": [0, 0, eye], "target": [0, 0, 0], "height": 65.0 / 16.0});
            let image = picture(
                both.load(name),
                json!({"camera": camera, "lights": light, "ambient": [0, 0, 0]}),
            );
            assert_color(name, image.center(), [2.0 / 4.0; 3], 1.0);
        }
    }
}

#[test]
fn a_camera_inside_a_body_sees_it_from_within() {
    let rig = Surface::sphere(24, 48).load("sphere");
    let camera = json!({"kind": "look_at", "eye": [0, 0, 0], "target": [0, 0, -1], "fov_y": 1.2});
    let image = picture(
        rig,
        json!({
            "camera": camera, "ambient": [0.1, 0.1, 0.1],
            "lights": [{"kind": "point", "position": [0, 0, 0], "intensity": 0.5}],
        }),
    );
    for (_, _, [red, ..]) in image.iter() {
        assert!((f64::from(red) - encoded(0.6)).abs() <= ROUND, "{red}");
    }
    // With bones through the eye and behind it.
    let figure = json!({"camera": {"kind": "look_at", "eye": [0, 1.2, 0], "target": [0, 1.2, -1]}, "show": {"skeleton": "wireframe", "skin_opacity": 0.5}, "samples": 4});
    picture("figure", figure);
}

// Skeletons and poses

#[test]
fn a_skeleton_of_one_joint_shows_a_dot() {
    // Falls onto the middle of pixel (40, 28).
    let rig = load_skeleton("one joint", "balljoint only { offset 0.5 0.25 0 }");
    let image = picture(rig, json!({}));
    let dot: Vec<_> = image
        .iter()
        .filter(|it| it.2 != BLACK)
        .map(|it| [it.0, it.1])
        .collect();
    let square: Vec<_> = (26..=30)
        .flat_map(|y| (38..=42).map(move |x| [x, y]))
        .collect();
    assert_eq!(dot, square);
}

#[test]
fn a_bone_is_a_line_from_joint_to_joint() {
    let rig = load_skeleton(
        "two joints",
        "balljoint a { offset -1 -0.5 0 pose 0 0 0.4 balljoint b { offset 2 0 0 } }",
    );
    let drawn = draw(&SERVICE, &request(rig, json!({"samples": 4})));
    let end = [-1.0 + 2.0 * 0.4f64.cos(), -0.5 + 2.0 * 0.4f64.sin(), 0.0];
    let is_drawn = |[x, y]: [f64; 2]| drawn.image.at(x as usize, y as usize) != BLACK;
    for share in [0.0, 0.3, 0.5, 0.7, 1.0] {
        let point = [
            -1.0 + share * (end[0] + 1.0),
            -0.5 + share * (end[1] + 0.5),
            0.0,
        ];
        let [x, y] = drawn.pixel_by_clip(point);
        assert!(is_drawn([x, y]), "at {share}");
        assert!(
            !is_drawn([x, y - 6.0]) && !is_drawn([x, y + 6.0]),
            "beside {share}"
        );
    }
}

/// Of the figure, from before, large enough for bones to be told apart.
fn of_figure(changes: Value) -> Image {
    let mut base = json!({
        "size": [96, 128],
        "camera": {"kind": "look_at", "eye": [0, 0.9, 5], "target": [0, 0.9, 0], "height": 2.1},
        "pose": {"base": "rest"},
    });
    let changes: serde_json::Map<String, Value> = serde_json::from_value(changes).expect("fields");
    base.as_object_mut().expect("an object").extend(changes);
    picture("figure", base)
}

#[test]
fn skin_hides_the_skeleton_behind_it_as_far_as_it_is_opaque() {
    // A bone along x, a wall behind its left half and one before its right half.
    let half = |middle: f64, z: f64| {
        let mut half = Surface::square(0.8, z);
        half.positions.iter_mut().for_each(|p| p[0] += middle);
        half
    };
    let walls = half(-1.0, -1.0).and(half(1.0, 1.0));
    let unmoved = "matrix { 1 0 0 0 1 0 0 0 1 0 0 0 }";
    let bound = format!(
        "{}skinweights 8 {{ {} }} bindings 2 {{ {unmoved} {unmoved} }}",
        walls.text(),
        "1 0 1 ".repeat(8)
    );
    let bone = "balljoint left { offset -1.5 0 0 balljoint right { offset 3 0 0 } }";
    // The walls stay where they were modelled when the root stands at the origin.
    let files = json!([{"name": "bone.skel", "text": bone}, {"name": "walls.skin", "text": bound}]);
    ask_ok(
        &SERVICE,
        "rig.load",
        json!({"name": "bone and walls", "files": files}),
    );
    let show = |skin: &str, skeleton: &str, opacity: f64| {
        picture(
            "bone and walls",
            json!({
                "show": {"skin": skin, "skeleton": skeleton, "skin_opacity": opacity},
                "material": {"diffuse": [0.2, 0.4, 0.9], "specular": [0, 0, 0]},
            }),
        )
    };
    let nothing = show("none", "none", 1.0);
    assert!(nothing.iter().all(|it| it.2 == BLACK));
    let bones = show("none", "wireframe", 1.0);
    let skin = show("bind", "none", 1.0);
    let [behind, before] = [[16, 32], [48, 32]];
    let bone = bones.at(behind[0], behind[1]);
    assert_ne!(bone, BLACK);
    assert_eq!(bones.at(before[0], before[1]), bone);
    assert_color(
        "a wall",
        skin.at(before[0], before[1]),
        [0.2, 0.4, 0.9],
        1.0,
    );
    for opacity in [1.0, 0.5, 0.2] {
        let both = show("bind", "wireframe", opacity);
        assert_eq!(
            both.at(behind[0], behind[1]),
            bone,
            "the bone hides the wall behind it"
        );
        let mixed = [0.2, 0.4, 0.9].map(|c| c * opacity);
        let mixed = [0, 1, 2].map(|i| mixed[i] + (1.0 - opacity) * linear(bone[i]));
        let found = both.at(before[0], before[1]);
        let off = (0..3)
            .map(|i| (f64::from(found[i]) - encoded(mixed[i])).abs())
            .fold(0.0, f64::max);
        // The bone's own color has been rounded once.
        assert!(off <= EXACT + 0.5, "{found:?}, wanted {mixed:?}");
    }
}

#[test]
fn a_bound_skin_does_not_follow_the_pose() {
    let in_pose = |skin: &str, angle: f64| {
        of_figure(
            json!({"pose": {"base": "rest", "dofs": {"pelvis.rz": angle}, "limits": "ignore"}, "show": {"skin": skin}}),
        )
    };
    assert_eq!(in_pose("bind", 0.0), in_pose("bind", 1.5));
    assert_ne!(in_pose("posed", 0.0), in_pose("posed", 1.5));
}

#[test]
fn a_picture_is_the_same_whenever_it_is_asked_for() {
    let colored = json!({"lights": [{"kind": "directional", "direction": [0, -1, -1]}], "samples": 4, "show": {"skin_opacity": 0.5, "skeleton": "wireframe"}});
    let first = of_figure(colored.clone());
    // Other sizes and layers in between use other targets.
    of_figure(json!({"size": [50, 50]}));
    of_figure(json!({"samples": 4}));
    assert_eq!(of_figure(colored), first);
}

//! The rasteriser against one that looks at every sample of every pixel in exact integers, and the same picture by every vector unit.

use super::bin::pixels;
use super::grid::{Grid, Rectangle, TILE};
use super::project::{Projected, STEPS};
use super::raster::{Footprint, Mark, Nearest, Opaque, draw};
use super::samples::Layer;
use super::samples::{
    BLOCK, BLOCK_COLUMNS, BLOCK_PIXELS, NONE, Pattern, STEPS_IN_EIGHTH, TileSamples,
};
use super::{Cores, Cpu, Parallelism};
use crate::frame::Outputs;
use crate::limits::Limits;
use crate::pose::{Pose, Posed, Skinning};
use crate::random::Random;
use crate::render::Plan;
use crate::rig::{Draft, MeshDraft};
use crate::scene::{
    Appearance, Background, Bounds, Camera, Color, Light, LookAt, Near, Orbit, Samples, Scene,
    Show, ShowSkeleton, Size, VertexQuery,
};
use fearless_simd::{Level, dispatch};
use glam::{Vec2, Vec3};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

const PATTERNS: [Pattern; 2] = [Pattern::of(Samples::One), Pattern::of(Samples::Four)];

/// From `low` to `high`, both included.
fn whole(random: &mut Random, low: i32, high: i32) -> i32 {
    low + random.below((high - low + 1) as usize) as i32
}

fn corner(x: i32, y: i32) -> Projected {
    Projected {
        x,
        y,
        pixel: [x, y].map(|steps| steps as f32 / STEPS as f32),
        depth: 0.5,
        inverse_w: 1.0,
    }
}

/// Pixel and sample.
type Hit = (u32, u32, usize);

/// By the definition: inside all three edges, or on one that is top or left.
fn exact(corners: [Projected; 3], pattern: Pattern) -> BTreeSet<Hit> {
    let at = corners.map(|corner| [i128::from(corner.x), i128::from(corner.y)]);
    let cross = |a: [i128; 2], b: [i128; 2], p: [i128; 2]| {
        (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    };
    let at = match cross(at[0], at[1], at[2]) {
        0 => return BTreeSet::new(),
        area if area > 0 => at,
        _ => [at[0], at[2], at[1]],
    };
    let is_inside = |p: [i128; 2]| {
        (0..3).all(|edge| {
            let (a, b) = (at[edge], at[(edge + 1) % 3]);
            let is_top = a[1] == b[1] && b[0] > a[0];
            let is_left = b[1] < a[1];
            let value = cross(a, b, p);
            value > 0 || (value == 0 && (is_top || is_left))
        })
    };
    let mut hits = BTreeSet::new();
    for y in 0..TILE[1] {
        for x in 0..TILE[0] {
            for (sample, offset) in pattern.positions().iter().enumerate() {
                let p = [(x, offset[0]), (y, offset[1])].map(|(pixel, eighths)| {
                    i128::from(pixel) * i128::from(STEPS) + i128::from(eighths * STEPS_IN_EIGHTH)
                });
                if is_inside(p) {
                    hits.insert((x, y, sample));
                }
            }
        }
    }
    hits
}

/// By the rasteriser, into a tile of its own.
fn drawn(level: Level, corners: [Projected; 3], pattern: Pattern) -> BTreeSet<Hit> {
    let mut tile = TileSamples::default();
    tile.clear(pattern);
    let [width, height] = TILE;
    let reached = pixels(corners, Size { width, height }, pattern);
    if let Some(reached) = reached.filter(|_| super::triangle::side(corners).is_some()) {
        let reached = Rectangle {
            min: reached.min,
            max: reached.max,
        };
        dispatch!(level, simd => {
            let footprint = Footprint::of(simd, pattern);
            let mark = Mark { layer: Layer::Base, number: 7 };
            let target = Nearest { tile: &mut tile, mark };
            draw(&footprint, target, [0, 0], corners, reached, &Opaque);
        });
    }
    let mut hits = BTreeSet::new();
    for block in 0..(BLOCK_COLUMNS * TILE[1] / BLOCK) as usize {
        let Some(shown) = tile.shown(block, Layer::Base) else {
            continue;
        };
        for pixel in 0..BLOCK_PIXELS {
            for sample in 0..pattern.count() {
                let found = shown[pixel * pattern.count() + sample];
                assert!(found == 7 || found == NONE);
                if found == 7 {
                    let x = (block as u32 % BLOCK_COLUMNS) * BLOCK + pixel as u32 % BLOCK;
                    let y = (block as u32 / BLOCK_COLUMNS) * BLOCK + pixel as u32 / BLOCK;
                    hits.insert((x, y, sample));
                }
            }
        }
    }
    hits
}

/// Every vector unit that this machine has.
pub(super) fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![best];
    #[cfg(target_arch = "x86_64")]
    {
        use fearless_simd::Simd;
        levels.extend(best.as_avx2().map(Simd::level));
        levels.extend(best.as_sse4_2().map(Simd::level));
        levels.extend(best.as_sse2().map(Simd::level));
    }
    levels
}

/// A corner of the kind that triangle `index` is made of: anywhere near the tile, on the grid of samples, on pixels' corners, far away.
fn random_corner(random: &mut Random, index: usize) -> Projected {
    let (width, height) = (TILE[0] as i32 * STEPS, TILE[1] as i32 * STEPS);
    // Odd multiples, few of them, so that many an edge runs through samples.
    let odd = |of: i32, random: &mut Random| of * (2 * whole(random, 0, 6) + 1);
    match index % 6 {
        0 => corner(
            whole(random, -2000, width + 2000),
            whole(random, -2000, height + 2000),
        ),
        1 => corner(
            32 * whole(random, 0, width / 32),
            32 * whole(random, 0, height / 32),
        ),
        2 => corner(odd(32, random), odd(32, random)),
        3 => corner(odd(128, random), odd(128, random)),
        4 => corner(whole(random, 2560, 3200), whole(random, 2560, 3200)),
        _ => corner(
            whole(random, -8192 * STEPS, 24576 * STEPS),
            whole(random, -8192 * STEPS, 24576 * STEPS),
        ),
    }
}

#[test]
fn a_triangle_covers_the_samples_that_are_in_it_and_no_other() {
    let mut random = Random(1);
    let mut seen = 0;
    for index in 0..600 {
        let corners = [0; 3].map(|_| random_corner(&mut random, index));
        for pattern in PATTERNS {
            let wanted = exact(corners, pattern);
            seen += wanted.len();
            for level in levels() {
                let found = drawn(level, corners, pattern);
                assert_eq!(found, wanted, "{corners:?}, {pattern:?}, {level:?}");
            }
        }
    }
    assert!(
        seen > 100_000,
        "{seen} samples are too few to prove anything"
    );
}

#[test]
fn triangles_around_a_point_share_every_sample_out_once() {
    let mut random = Random(2);
    for index in 0..200 {
        let middle = random_corner(&mut random, index % 5);
        // Around the middle in the order of their angles, near and far.
        let mut angles: Vec<f64> = (0..7).map(|_| random.unit() * 6.2).collect();
        angles.sort_by(f64::total_cmp);
        let around: Vec<Projected> = angles
            .iter()
            .map(|angle| {
                let reach = f64::from(whole(&mut random, 300, 20_000));
                corner(
                    middle.x + (reach * angle.cos()) as i32,
                    middle.y + (reach * angle.sin()) as i32,
                )
            })
            .collect();
        for pattern in PATTERNS {
            let mut hits = BTreeSet::new();
            for (at, &from) in around.iter().enumerate() {
                let to = around[(at + 1) % around.len()];
                // Where the last angle is more than half a turn from the first, a triangle there would lie over the others.
                let turn = (angles[(at + 1) % angles.len()] - angles[at])
                    .rem_euclid(std::f64::consts::TAU);
                if turn >= std::f64::consts::PI {
                    continue;
                }
                for hit in drawn(Level::new(), [middle, from, to], pattern) {
                    assert!(hits.insert(hit), "{hit:?} is in two triangles, {index}");
                }
            }
        }
    }
}

#[test]
fn two_halves_of_a_square_cover_it() {
    // Corners on samples and between them.
    for offset in 0..64 {
        let [left, right] = [300 + offset, 300 + offset + 12 * 128];
        let [top, bottom] = [500 + offset, 500 + offset + 7 * 160];
        let [a, b] = [corner(left, top), corner(right, top)];
        let [c, d] = [corner(left, bottom), corner(right, bottom)];
        for pattern in PATTERNS {
            let halves = [
                drawn(Level::new(), [a, b, c], pattern),
                drawn(Level::new(), [b, d, c], pattern),
            ];
            assert!(halves[0].is_disjoint(&halves[1]));
            let whole: BTreeSet<Hit> = halves.concat_sets();
            let inside = |first: i32, last: i32, pixel: u32, eighths: i32| {
                let at = pixel as i32 * STEPS + eighths * STEPS_IN_EIGHTH;
                first <= at && at < last
            };
            let mut wanted = BTreeSet::new();
            for y in 0..TILE[1] {
                for x in 0..TILE[0] {
                    for (sample, at) in pattern.positions().iter().enumerate() {
                        if inside(left, right, x, at[0]) && inside(top, bottom, y, at[1]) {
                            wanted.insert((x, y, sample));
                        }
                    }
                }
            }
            assert_eq!(whole, wanted, "{offset}, {pattern:?}");
        }
    }
}

trait ConcatSets {
    fn concat_sets(&self) -> BTreeSet<Hit>;
}

impl ConcatSets for [BTreeSet<Hit>; 2] {
    fn concat_sets(&self) -> BTreeSet<Hit> {
        self.iter().flatten().copied().collect()
    }
}

#[test]
fn the_exact_rasteriser_tells_edges_apart() {
    // Corners on the middles of pixels: a sample on the top or the left edge belongs, one on the others does not.
    let [a, b, c] = [
        corner(128, 128),
        corner(128 + 512, 128),
        corner(128, 128 + 512),
    ];
    let hits = exact([a, b, c], PATTERNS[0]);
    let wanted = [(0, 0, 0), (1, 0, 0), (0, 1, 0)];
    assert_eq!(hits, wanted.into_iter().collect());
    assert_ne!(exact([a, b, corner(128, 128 + 513)], PATTERNS[0]), hits);
}

#[test]
fn a_picture_has_as_many_tiles_as_it_needs() {
    for (width, height, tiles) in [
        (1, 1, 1),
        (TILE[0], TILE[1], 1),
        (TILE[0] + 1, TILE[1], 2),
        (640, 480, 150),
    ] {
        assert_eq!(Grid::of(Size { width, height }).tile_count(), tiles);
    }
}

/// Triangles of all sizes through each other, more than one thread takes at a time.
fn tangle(random: &mut Random) -> Arc<Posed> {
    let positions: Vec<Vec3> = (0..9000)
        .map(|_| {
            Vec3::new(
                random.unit() as f32 - 0.5,
                random.unit() as f32 - 0.5,
                random.unit() as f32 - 0.5,
            )
        })
        .collect();
    let triangles = (0..9000)
        .map(|_| [0; 3].map(|_| whole(random, 0, 8999) as u32))
        .collect();
    let mesh = MeshDraft {
        normals: Some(
            positions
                .iter()
                .map(|position| position.normalize_or(Vec3::Y))
                .collect(),
        ),
        texcoords: Some(
            positions
                .iter()
                .map(|position| Vec2::new(position.x, position.y))
                .collect(),
        ),
        positions,
        triangles,
        ..MeshDraft::default()
    };
    let draft = Draft {
        meshes: vec![mesh],
        ..Draft::default()
    };
    let rig = Arc::new(draft.build(&Limits::default()).unwrap());
    Arc::new(Posed::new(&Pose::rest(&rig)).unwrap())
}

fn scene(
    width: u32,
    height: u32,
    samples: Samples,
    opacity: f64,
    distance: f64,
) -> (Scene, Appearance) {
    let size = Size { width, height };
    let bounds = Bounds {
        min: glam::DVec3::splat(-0.5),
        max: glam::DVec3::splat(0.5),
    };
    let orbit = Orbit {
        distance: Some(distance),
        ..Orbit::default()
    };
    let (skin, normals) = Default::default();
    let scene = Scene {
        size,
        samples,
        camera: Camera::orbit(orbit, &bounds, size).unwrap(),
        lights: Light::default_pair(),
        ambient: Color::constant(0.1, 0.1, 0.1),
        background: Background::default(),
    };
    let appearance = Appearance {
        show: Show::new(skin, ShowSkeleton::None, normals, opacity).unwrap(),
        ..Appearance::default()
    };
    (scene, appearance)
}

#[test]
fn every_vector_unit_and_any_number_of_threads_come_to_the_same_bytes() {
    let mut random = Random(3);
    let posed = tangle(&mut random);
    let all = VertexQuery {
        instance: 0,
        mesh: 0,
        start: 0,
        count: 9000,
        positions: true,
        normals: true,
    };
    let mut plans: Vec<Plan> = [Skinning::Linear, Skinning::DualQuaternion]
        .map(|skinning| {
            Plan::vertices(
                Arc::clone(&posed),
                skinning,
                crate::scene::Shape::Posed,
                vec![all],
            )
        })
        .to_vec();
    for (width, height, samples, opacity, distance) in [
        (200, 150, Samples::Four, 1.0, 2.0),
        (131, 67, Samples::One, 1.0, 1.0),
        (64, 33, Samples::Four, 0.4, 0.3),
    ] {
        let (scene, appearance) = scene(width, height, samples, opacity, distance);
        plans.push(Plan::picture(
            Arc::clone(&posed),
            Skinning::Linear,
            appearance,
            scene,
            1.0,
        ));
    }
    for (index, plan) in plans.iter().enumerate() {
        let wanted: Option<Outputs> =
            Cpu::with(Level::new()).render(plan, Parallelism::uncancelled(Cores::One));
        for level in levels() {
            let cpu = Cpu::with(level);
            assert!(
                cpu.render(plan, Parallelism::uncancelled(Cores::One)) == wanted,
                "plan {index}, {level:?}"
            );
            for threads in [1, 2, 3, 7] {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .unwrap();
                let found = pool.install(|| cpu.render(plan, Parallelism::uncancelled(Cores::All)));
                assert!(
                    found == wanted,
                    "plan {index}, {level:?}, {threads} threads"
                );
            }
        }
    }
}

#[test]
fn what_was_drawn_before_does_not_show() {
    let mut random = Random(4);
    let posed = tangle(&mut random);
    let plan = |width, opacity, samples| {
        let (scene, appearance) = scene(width, 90, samples, opacity, 1.5);
        Plan::picture(Arc::clone(&posed), Skinning::Linear, appearance, scene, 1.0)
    };
    let plans = [
        plan(90, 1.0, Samples::Four),
        plan(200, 0.5, Samples::One),
        plan(64, 0.5, Samples::Four),
    ];
    let used = Cpu::default();
    for _ in 0..3 {
        for plan in &plans {
            let fresh = Cpu::default().render(plan, Parallelism::uncancelled(Cores::One));
            assert!(used.render(plan, Parallelism::uncancelled(Cores::One)) == fresh);
        }
    }
}

/// A triangle, and the direction in which it is lit.
type Lit = ([Vec3; 3], Vec3);

/// Each with corners of its own, as a plan of a picture straight from before, without perspective: one unit fits its height.
fn seen_flat<'a>(triangles: impl Iterator<Item = &'a Lit>, width: u32, height: u32) -> Plan {
    let mut mesh = MeshDraft::default();
    let mut normals = Vec::new();
    for (corners, normal) in triangles {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners);
        normals.extend([*normal; 3]);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    mesh.normals = Some(normals);
    let draft = Draft {
        meshes: vec![mesh],
        ..Draft::default()
    };
    let rig = Arc::new(draft.build(&Limits::default()).unwrap());
    let posed = Arc::new(Posed::new(&Pose::rest(&rig)).unwrap());
    let (mut scene, appearance) = scene(width, height, Samples::Four, 1.0, 1.0);
    let look = LookAt {
        eye: glam::DVec3::new(0.0, 0.0, 10.0),
        target: glam::DVec3::ZERO,
        up: glam::DVec3::Y,
        fov_y: None,
        height: Some(1.0),
        near: Near(None),
    };
    let bounds = Bounds {
        min: glam::DVec3::splat(-0.5),
        max: glam::DVec3::splat(0.5),
    };
    scene.camera = Camera::look_at(look, &bounds, scene.size).unwrap();
    Plan::picture(posed, Skinning::Linear, appearance, scene, 1.0)
}

/// Random ones, each further ahead than those before it.
fn stacked(random: &mut Random, count: usize, largest: f32) -> Vec<Lit> {
    let triangle = |index: usize| {
        let middle = Vec3::new(
            random.unit() as f32 - 0.5,
            random.unit() as f32 - 0.5,
            index as f32 * 1e-5,
        );
        let size = largest * random.unit() as f32;
        let corners = [Vec3::ZERO, Vec3::X * size, Vec3::Y * size].map(|corner| middle + corner);
        let tilt = Vec3::new(random.unit() as f32 - 0.5, random.unit() as f32 - 0.5, 1.0);
        (corners, tilt.normalize_or(Vec3::Z))
    };
    (0..count).map(triangle).collect()
}

#[test]
fn the_order_of_triangles_does_not_matter() {
    // More than a tile keeps; and such as reach many tiles and hide whole blocks.
    for (count, largest, width, height) in [(150_000, 0.1, 64, 32), (3000, 3.0, 640, 480)] {
        let triangles = stacked(&mut Random(5), count, largest);
        let draw = |plan: Plan| Cpu::default().render(&plan, Parallelism::uncancelled(Cores::One));
        let back_to_front = draw(seen_flat(triangles.iter(), width, height));
        let front_to_back = draw(seen_flat(triangles.iter().rev(), width, height));
        assert!(back_to_front.is_some());
        assert!(back_to_front == front_to_back, "{count} triangles");
    }
}

#[test]
fn of_two_that_are_equally_near_the_first_one_shows() {
    let triangle = |size: f32, normal| ([Vec3::ZERO, Vec3::X * size, Vec3::Y * size], normal);
    // One reaches a tile, the other one many.
    let small = triangle(0.02, Vec3::Z);
    let large = triangle(0.5, Vec3::new(0.6, 0.0, 0.8));
    let draw = |lit: [Lit; 2]| {
        let plan = seen_flat(lit.iter(), 640, 480);
        Cpu::default().render(&plan, Parallelism::uncancelled(Cores::One))
    };
    let (small_first, large_first) = (draw([small, large]), draw([large, small]));
    assert!(small_first != large_first);
    assert!(large_first == draw([large, large]));
}

#[test]
fn a_cancelled_picture_is_not_drawn_on() {
    let plan = seen_flat(stacked(&mut Random(7), 20_000, 0.1).iter(), 640, 480);
    let cpu = Cpu::default();
    let whole = cpu.render(&plan, Parallelism::uncancelled(Cores::One));
    let asked_of_all = {
        let asked = AtomicUsize::new(0);
        let count = || asked.fetch_add(1, Ordering::Relaxed) == usize::MAX;
        assert!(cpu.render(&plan, Parallelism::cancellable(Cores::One, &count)) == whole);
        asked.into_inner()
    };
    // Of every stage at least.
    assert!(asked_of_all > 100, "{asked_of_all}");
    for last in (0..asked_of_all).step_by(7) {
        let asked = AtomicUsize::new(0);
        let is_cancelled = || asked.fetch_add(1, Ordering::Relaxed) >= last;
        assert!(
            cpu.render(&plan, Parallelism::cancellable(Cores::One, &is_cancelled))
                .is_none()
        );
        assert!(asked.into_inner() < last + 50, "it went on from {last}");
    }
    assert!(cpu.render(&plan, Parallelism::uncancelled(Cores::All)) == whole);
}

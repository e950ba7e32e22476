//! Lines over two logarithmic axes, as SVG. Never lives here: what they show.

use std::fmt::Write;

/// One picture: cost against size.
pub struct Plot {
    pub title: String,
    pub x: &'static str,
    pub y: &'static str,
    pub lines: Vec<Line>,
}

pub struct Line {
    pub label: String,
    /// The least that is possible is dashed.
    pub is_floor: bool,
    /// Those of size 0 have no place on a logarithmic axis and are left out.
    pub points: Vec<(f64, f64)>,
}

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 400.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 470.0;
const TOP: f64 = 60.0;
const BOTTOM: f64 = 340.0;
/// Greys and colors of middling brightness, which can be told from a white and from a black page alike.
const INK: &str = "#808080";
const COLORS: [&str; 3] = ["#2d8fd0", "#d2691e", "#3a9a5b"];

/// A logarithmic axis.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

/// An axis is at least so many times as long as where it starts, so that noise does not fill the picture.
const LEAST_SPAN: f64 = 10.0;
/// Room at both ends.
const MARGIN: f64 = 1.15;

impl Axis {
    fn around(values: impl Iterator<Item = f64> + Clone, from: f64, to: f64) -> Self {
        let low = values.clone().fold(f64::INFINITY, f64::min);
        let high = values.fold(0.0, f64::max);
        let missing = (LEAST_SPAN * low / high).max(1.0).sqrt();
        Self {
            low: low / missing / MARGIN,
            high: high * missing * MARGIN,
            from,
            to,
        }
    }

    fn place(&self, value: f64) -> f64 {
        let share = (value / self.low).ln() / (self.high / self.low).ln();
        self.from + share * (self.to - self.from)
    }

    /// 1, 2 and 5 of each decade, or over many decades 1 alone.
    fn marks(&self) -> Vec<f64> {
        let digits: &[f64] = match self.high / self.low {
            ..=1000.0 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let marks = decades.flat_map(|power| digits.iter().map(move |digit| (digit, power)));
        marks
            .map(|(digit, power)| match power {
                // A quotient of whole numbers prints as few digits as it has.
                ..0 => digit / 10f64.powi(-power),
                _ => digit * 10f64.powi(power),
            })
            .filter(|value| (self.low..=self.high).contains(value))
            .collect()
    }
}

impl Plot {
    /// The file, or nothing where there is no point to show.
    pub fn svg(&self) -> Option<String> {
        let points = || self.lines.iter().flat_map(Line::shown);
        points().next()?;
        let xs = Axis::around(points().map(|(x, _)| x), LEFT, RIGHT);
        let ys = Axis::around(points().map(|(_, y)| y), BOTTOM, TOP);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
             font-family=\"sans-serif\" font-size=\"12\" fill=\"{INK}\">\n"
        );
        text(&mut svg, (LEFT, 22.0), "start", 14, &self.title);
        for value in xs.marks() {
            let x = xs.place(value);
            rule(&mut svg, (x, TOP), (x, BOTTOM));
            text(&mut svg, (x, BOTTOM + 18.0), "middle", 12, &short(value));
        }
        for value in ys.marks() {
            let y = ys.place(value);
            rule(&mut svg, (LEFT, y), (RIGHT, y));
            text(&mut svg, (LEFT - 8.0, y + 4.0), "end", 12, &short(value));
        }
        let middle = (LEFT + RIGHT) / 2.0;
        text(&mut svg, (middle, BOTTOM + 42.0), "middle", 12, self.x);
        text(&mut svg, (LEFT, TOP - 12.0), "start", 12, self.y);
        for (index, line) in self.lines.iter().enumerate() {
            // A line and the floor beneath it have one color.
            let color = COLORS[index / 2 % COLORS.len()];
            let dashes = if line.is_floor {
                " stroke-dasharray=\"6 4\""
            } else {
                ""
            };
            let stroke = format!("fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"{dashes}");
            let places: Vec<String> = line
                .shown()
                .map(|(x, y)| format!("{:.1},{:.1}", xs.place(x), ys.place(y)))
                .collect();
            let _ = writeln!(svg, "<polyline points=\"{}\" {stroke}/>", places.join(" "));
            if !line.is_floor {
                for (x, y) in places.iter().filter_map(|place| place.split_once(',')) {
                    let _ = writeln!(
                        svg,
                        "<circle cx=\"{x}\" cy=\"{y}\" r=\"3\" fill=\"{color}\"/>"
                    );
                }
            }
            let y = TOP + 16.0 + 20.0 * index as f64;
            let (from, to) = (RIGHT + 14.0, RIGHT + 42.0);
            let _ = writeln!(svg, "<polyline points=\"{from},{y} {to},{y}\" {stroke}/>");
            text(&mut svg, (to + 6.0, y + 4.0), "start", 12, &line.label);
        }
        Some(svg + "</svg>\n")
    }
}

impl Line {
    fn shown(&self) -> impl Iterator<Item = (f64, f64)> + Clone {
        self.points
            .iter()
            .copied()
            .filter(|(x, y)| *x > 0.0 && *y > 0.0)
    }
}

fn rule(svg: &mut String, (x1, y1): (f64, f64), (x2, y2): (f64, f64)) {
    let _ = writeln!(
        svg,
        "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{INK}\" stroke-opacity=\"0.35\"/>"
    );
}

fn text(svg: &mut String, (x, y): (f64, f64), anchor: &str, size: u32, words: &str) {
    let words = words.replace('&', "&amp;").replace('<', "&lt;");
    let _ = writeln!(
        svg,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-size=\"{size}\">{words}</text>"
    );
}

/// As it stands beside an axis.
fn short(value: f64) -> String {
    match value {
        1e6.. => format!("{}M", (value / 1e6).round()),
        1e3.. => format!("{}k", (value / 1e3).round()),
        1.0.. => format!("{}", value.round()),
        _ => format!("{value}"),
    }
}

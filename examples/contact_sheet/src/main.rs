//! A contact sheet: what one daemon makes of one rig, in one picture. Asks for all of it before it reads the first answer.
//!
//! ```text
//! cargo run --release --package contact_sheet -- 127.0.0.1:7443 sheet.png
//! ```

use anyhow::{Context, bail};
use image::RgbaImage;
use rigd::client::Client;
use rigd::protocol::frame::Frame;
use serde_json::{Value, json};

/// Side of a small picture in pixels; the large one is two wide and three high.
const CELL: u32 = 200;

/// A picture, and where its upper left corner lies, in cells.
struct Cell {
    column: u32,
    row: u32,
    request: Value,
}

fn cells() -> Vec<Cell> {
    let wave = json!({
        "upper_arm_r.rx": -1.40, "upper_arm_r.ry": 0.17, "upper_arm_r.rz": 0.31, "forearm_r.rx": -0.35, "forearm_r.ry": 1.66,
        "hand_r.rz": -0.17, "fingers_r.rz": 0.09, "upper_arm_l.rz": -1.08, "forearm_l.ry": -1.05, "head.rz": 0.14,
        "spine.rz": 0.07, "morph.smile": 0.8,
    });
    let cell = |column, row, request| Cell {
        column,
        row,
        request,
    };
    let hero = json!({"pose": {"dofs": wave}, "size": [2 * CELL, 3 * CELL],
        "camera": {"kind": "look_at", "eye": [0.75, 1.07, 2.6], "target": [-0.03, 0.9, 0], "fov_y": 0.76}});
    let mut cells = vec![cell(0, 0, hero)];

    let face = json!({"kind": "look_at", "eye": [-0.08, 1.62, 0.85], "target": [0.02, 1.58, 0.03], "fov_y": 0.42});
    for (column, [smile, blink]) in (2..).zip([[0.0, 0.0], [1.0, 0.0], [0.6, 1.0]]) {
        let dofs = json!({"morph.smile": smile, "morph.blink": blink});
        cells.push(cell(
            column,
            0,
            json!({"pose": {"dofs": dofs}, "camera": face}),
        ));
    }
    let aside =
        json!({"kind": "look_at", "eye": [-3.4, 1.1, 2.2], "target": [0, 0.87, 0], "fov_y": 0.48});
    for (column, time) in (2..).zip([0.02, 0.2, 0.42]) {
        let pose = json!({"clip": {"name": "walk", "time": time}, "dofs": {"pelvis.tz": 0}});
        cells.push(cell(column, 1, json!({"pose": pose, "camera": aside})));
    }
    let stride = json!({"clip": {"name": "walk", "time": 0.02}, "dofs": {"pelvis.tz": 0}});
    for (column, show) in (2..).zip([
        json!({"skeleton": "sticks", "skin_opacity": 0.4}),
        json!({"skeleton": "boxes", "skin": "none"}),
        json!({"skeleton": "cylinders", "skin": "none"}),
    ]) {
        cells.push(cell(
            column,
            2,
            json!({"pose": stride, "show": show, "camera": aside}),
        ));
    }
    cells
}

/// Asks the daemon at `address`, which has the built-in figure loaded.
pub fn sheet(address: &str) -> anyhow::Result<RgbaImage> {
    let mut client = Client::connect(address)?;
    let cells = cells();
    for cell in &cells {
        let mut request = json!({"rig": "figure", "size": [CELL, CELL], "transport": "attach"});
        let members = request.as_object_mut().context("an object")?;
        members.extend(cell.request.as_object().context("an object")?.clone());
        client.send("frame.render", &request)?;
    }
    let columns = cells.iter().map(|cell| cell.column + 1).max().unwrap_or(0);
    let mut sheet = RgbaImage::new(columns * CELL, 3 * CELL);
    for cell in &cells {
        let received = client.receive()?;
        let result = match received.outcome {
            Ok(result) => result,
            Err(error) => bail!("{error}"),
        };
        let frame: Frame = serde_json::from_str(result.get())?;
        let png = frame.images["color"].bytes(&received.attached)?;
        let picture = image::load_from_memory(&png)?;
        let [x, y] = [cell.column, cell.row].map(|cells| i64::from(cells * CELL));
        image::imageops::replace(&mut sheet, &picture, x, y);
    }
    Ok(sheet)
}

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let address = arguments
        .next()
        .unwrap_or_else(|| "127.0.0.1:7443".to_owned());
    let file = arguments.next().unwrap_or_else(|| "sheet.png".to_owned());
    sheet(&address)?.save(&file)?;
    println!("{file}");
    Ok(())
}

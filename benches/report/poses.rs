//! One pose of many degrees of freedom, written in each of the ways there are. Never lives here: what it costs.

use crate::scenes::Subject;
use crate::wire::request;

pub const FORMS: [&str; 3] = [
    "by name",
    "as a list of `dof_values`",
    "as attached `dof_values`",
];

/// Poses that come round, so that neighbours differ.
const POSES: usize = 64;

/// Requests whose pose sets all angles of the rig, and in the latter two forms the root's displacement as well, to 0.
pub fn requests(subject: &Subject, method: &str, form: usize) -> Vec<Vec<u8>> {
    let rig = subject.name();
    let of_pose = |number: usize| {
        let dofs = subject.loaded.rig.dofs().all().iter().enumerate();
        let values: Vec<(&str, f32)> = dofs
            .map(|(index, dof)| {
                let angle = 0.01 + 1e-4 * number as f32 + 1e-5 * index as f32;
                let turns = [".rx", ".ry", ".rz"]
                    .iter()
                    .any(|end| dof.name.ends_with(end));
                (dof.name.as_str(), if turns { angle } else { 0.0 })
            })
            .collect();
        let (pose, attached) = match form {
            0 => {
                let turned = values.iter().filter(|(_, value)| *value != 0.0);
                let members: Vec<String> = turned
                    .map(|(name, value)| format!("\"{name}\":{value}"))
                    .collect();
                (format!("\"dofs\":{{{}}}", members.join(",")), Vec::new())
            }
            1 => {
                let numbers: Vec<String> =
                    values.iter().map(|(_, value)| value.to_string()).collect();
                let list = numbers.join(",");
                (format!("\"dof_values\":[{list}]"), Vec::new())
            }
            _ => {
                let bytes: Vec<u8> = values
                    .iter()
                    .flat_map(|(_, value)| value.to_le_bytes())
                    .collect();
                let place = format!("{{\"offset\":0,\"bytes\":{}}}", bytes.len());
                (format!("\"dof_values\":{{\"attach\":{place}}}"), bytes)
            }
        };
        let params = format!("{{\"rig\":\"{rig}\",\"pose\":{{{pose}}}}}");
        request(method, &params, &attached)
    };
    (0..POSES).map(of_pose).collect()
}

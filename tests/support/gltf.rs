//! Small glTF files made by hand: numbers go into one buffer, everything else is JSON that a test may bend as it likes.
//! Never lives here: what a reader should make of them.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

/// `componentType` of an accessor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Component {
    I8 = 5120,
    U8 = 5121,
    I16 = 5122,
    U16 = 5123,
    U32 = 5125,
    F32 = 5126,
}

impl Component {
    pub fn code(self) -> u64 {
        self as u64
    }

    /// One number, little-endian. What an integer cannot hold is cut off.
    pub fn bytes(self, number: f64) -> Vec<u8> {
        let whole = number as i64;
        match self {
            Self::I8 | Self::U8 => vec![whole as u8],
            Self::I16 | Self::U16 => (whole as u16).to_le_bytes().to_vec(),
            Self::U32 => (whole as u32).to_le_bytes().to_vec(),
            Self::F32 => (number as f32).to_le_bytes().to_vec(),
        }
    }
}

/// Numbers of one element, by its `type`.
pub fn width(shape: &str) -> usize {
    match shape {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        other => panic!("no shape `{other}`"),
    }
}

/// A document with all its numbers in one buffer. `json` is all of it but `buffers[0]`, which is written last.
#[derive(Debug, Clone)]
pub struct Gltf {
    pub json: Value,
    pub bytes: Vec<u8>,
}

impl Default for Gltf {
    fn default() -> Self {
        Self {
            json: json!({"asset": {"version": "2.0"}}),
            bytes: Vec::new(),
        }
    }
}

impl Gltf {
    /// Appends to one of the top-level lists, e.g. `nodes`; its index there.
    pub fn push(&mut self, list: &str, item: Value) -> usize {
        let list = &mut self.json[list];
        if list.is_null() {
            *list = json!([]);
        }
        let items = list.as_array_mut().expect("a list");
        items.push(item);
        items.len() - 1
    }

    /// A view of bytes that are appended to the buffer.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        // Every component lies at a multiple of its size.
        while !self.bytes.len().is_multiple_of(4) {
            self.bytes.push(0);
        }
        let view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        self.bytes.extend(bytes);
        self.push("bufferViews", view)
    }

    /// An accessor of its own view. Elements of odd sizes are padded to 4 bytes, as vertices have to be.
    pub fn accessor(&mut self, component: Component, shape: &str, numbers: &[f64]) -> usize {
        let (elements, rest) = (numbers.chunks_exact(width(shape)), numbers.len());
        assert_eq!(rest % width(shape), 0, "whole elements");
        let count = elements.len();
        let size = component.bytes(0.0).len() * width(shape);
        let is_padded = shape != "SCALAR" && !size.is_multiple_of(4);
        let mut bytes = Vec::new();
        for element in elements {
            bytes.extend(element.iter().flat_map(|&number| component.bytes(number)));
            while is_padded && !bytes.len().is_multiple_of(4) {
                bytes.push(0);
            }
        }
        let view = self.view(&bytes);
        if is_padded {
            self.json["bufferViews"][view]["byteStride"] = json!(size.next_multiple_of(4));
        }
        let bound = |fold: fn(f64, f64) -> f64| {
            let of_component = |at: usize| numbers.iter().skip(at).step_by(width(shape)).copied();
            let bound = |at: usize| of_component(at).reduce(fold).map(|it| it as f32);
            (0..width(shape)).map(bound).collect::<Vec<_>>()
        };
        let accessor = json!({
            "bufferView": view, "componentType": component.code(), "type": shape, "count": count,
            "min": bound(f64::min), "max": bound(f64::max),
        });
        self.push("accessors", accessor)
    }

    pub fn floats(&mut self, shape: &str, numbers: &[f64]) -> usize {
        self.accessor(Component::F32, shape, numbers)
    }

    /// As [`Self::accessor`], of integers that stand for 0..1 or −1..1.
    pub fn normalized(&mut self, component: Component, shape: &str, numbers: &[f64]) -> usize {
        let accessor = self.accessor(component, shape, numbers);
        self.json["accessors"][accessor]["normalized"] = json!(true);
        accessor
    }

    pub fn node(&mut self, node: Value) -> usize {
        self.push("nodes", node)
    }

    /// The default scene.
    pub fn scene(&mut self, roots: &[usize]) {
        let scene = self.push("scenes", json!({ "nodes": roots }));
        self.json["scene"] = json!(scene);
    }

    /// One more channel of the animation of this name, with a sampler of its own.
    pub fn channel(&mut self, clip: &str, target: Value, sampler: Value) {
        let known = self.json["animations"].as_array();
        let known = known.and_then(|clips| clips.iter().position(|it| it["name"] == clip));
        let index = known.unwrap_or_else(|| {
            let empty = json!({"name": clip, "samplers": [], "channels": []});
            self.push("animations", empty)
        });
        let animation = &mut self.json["animations"][index];
        let samplers = animation["samplers"].as_array_mut().expect("a list");
        samplers.push(sampler);
        let channel = json!({"sampler": samplers.len() - 1, "target": target});
        let channels = animation["channels"].as_array_mut().expect("a list");
        channels.push(channel);
    }

    /// Where the numbers of an accessor begin in the buffer.
    pub fn start_of(&self, accessor: usize) -> usize {
        let accessor = &self.json["accessors"][accessor];
        let view = accessor["bufferView"].as_u64().expect("an index") as usize;
        let view = &self.json["bufferViews"][view];
        let offset = |of: &Value| of["byteOffset"].as_u64().unwrap_or(0) as usize;
        offset(view) + offset(accessor)
    }

    /// Replaces a float of an accessor that has no stride.
    pub fn set_float(&mut self, accessor: usize, index: usize, number: f32) {
        let start = self.start_of(accessor) + 4 * index;
        self.bytes[start..start + 4].copy_from_slice(&number.to_le_bytes());
    }

    /// The document, the buffer wherever `uri` says; without it, in the binary chunk. A buffer that a test wrote itself stays.
    pub fn document(&self, uri: Option<&str>) -> Value {
        let mut document = self.json.clone();
        if document["buffers"].is_null() && !self.bytes.is_empty() {
            let mut buffer = json!({"byteLength": self.bytes.len()});
            if let Some(uri) = uri {
                buffer["uri"] = json!(uri);
            }
            document["buffers"] = json!([buffer]);
        } else if document["buffers"].is_null() {
            let members = document.as_object_mut().expect("an object");
            members.remove("buffers");
        }
        document
    }

    pub fn data_uri(&self) -> String {
        let bytes = STANDARD.encode(&self.bytes);
        format!("data:application/octet-stream;base64,{bytes}")
    }

    /// The document as text, its buffer in a data URI.
    pub fn text(&self) -> String {
        self.document(Some(&self.data_uri())).to_string()
    }

    /// As a request carries it: one file, `x.gltf`.
    pub fn files(&self) -> Value {
        json!([{"name": "x.gltf", "text": self.text()}])
    }

    /// The document and its buffer in one binary file.
    pub fn glb(&self) -> Vec<u8> {
        glb(self.document(None).to_string().as_bytes(), &self.bytes)
    }
}

/// A binary file of two chunks.
pub fn glb(json: &[u8], bytes: &[u8]) -> Vec<u8> {
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = bytes.to_vec();
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    glb_of(&[(*b"JSON", &json), (*b"BIN\0", &bytes)])
}

/// A binary file of any chunks, their lengths told as they are.
pub fn glb_of(chunks: &[([u8; 4], &[u8])]) -> Vec<u8> {
    let mut file = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, content) in chunks {
        file.extend((content.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(*content);
    }
    let length = file.len() as u32;
    file[8..12].copy_from_slice(&length.to_le_bytes());
    file
}

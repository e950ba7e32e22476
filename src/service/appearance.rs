//! How the wire wants a character to look. Never lives here: what is drawn of it.

use super::fault;
use super::names::unknown;
use crate::pose::Skinning;
use crate::protocol::FieldFault;
use crate::protocol::frame as wire;
use crate::rig::Rig;
use crate::scene::{Appearance, Color, Cull, Show, ShowNormals, ShowSkeleton, ShowSkin, Surface};

/// Of the character of a picture.
pub(super) fn appearance(params: &wire::FrameParams, rig: &Rig) -> Result<Appearance, FieldFault> {
    let of_material = |fault: FieldFault| fault.within("material");
    let variant = variant(&params.material, rig).map_err(of_material)?;
    let surface = surface(&params.material).map_err(of_material)?;
    Ok(Appearance {
        show: show(&params.show).map_err(|fault| fault.within("show"))?,
        surface: Surface { variant, ..surface },
        cull: match params.cull {
            wire::Cull::Auto => Cull::Auto,
            wire::Cull::Never => Cull::Never,
        },
    })
}

pub(super) fn skinning(skinning: wire::Skinning) -> Skinning {
    match skinning {
        wire::Skinning::Linear => Skinning::Linear,
        wire::Skinning::DualQuaternion => Skinning::DualQuaternion,
    }
}

fn variant(material: &wire::Material, rig: &Rig) -> Result<Option<usize>, FieldFault> {
    let Some(name) = &material.variant else {
        return Ok(None);
    };
    match rig.variants().iter().position(|variant| variant == name) {
        Some(variant) => Ok(Some(variant)),
        None => {
            let known = rig.variants().iter().map(String::as_str);
            let problem = unknown("variant", name, known);
            Err(FieldFault::new("variant", problem))
        }
    }
}

fn surface(material: &wire::Material) -> Result<Surface, FieldFault> {
    let color = |given: Option<[f64; 3]>, field: &'static str| {
        given.map(Color::new).transpose().map_err(fault::at(field))
    };
    let (diffuse, specular) = (
        color(material.diffuse, "diffuse")?,
        color(material.specular, "specular")?,
    );
    Surface::new(diffuse, specular, material.shininess).map_err(fault::at("shininess"))
}

fn show(show: &wire::Show) -> Result<Show, FieldFault> {
    let skin = match show.skin {
        wire::ShowSkin::Posed => ShowSkin::Posed,
        wire::ShowSkin::Bind => ShowSkin::Bind,
        wire::ShowSkin::None => ShowSkin::None,
    };
    let skeleton = match show.skeleton {
        wire::ShowSkeleton::None => ShowSkeleton::None,
        wire::ShowSkeleton::Wireframe => ShowSkeleton::Wireframe,
        wire::ShowSkeleton::Boxes => ShowSkeleton::Boxes,
        wire::ShowSkeleton::Sticks => ShowSkeleton::Sticks,
        wire::ShowSkeleton::Cylinders => ShowSkeleton::Cylinders,
    };
    let normals = match show.normals {
        wire::ShowNormals::Smooth => ShowNormals::Smooth,
        wire::ShowNormals::Flat => ShowNormals::Flat,
    };
    Show::new(skin, skeleton, normals, show.skin_opacity).map_err(fault::at("skin_opacity"))
}

//! JSON of a glTF file without what haze does not read, so that the reader of the rest does not refuse it.

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use haze_core::assets::json;
use haze_core::error::one_line;
use serde_json::Value;

use super::gltf_problem::{WHOLE, field_problem, gltf_problem, json_problem};
use super::name_list::listed;

const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// Extensions that are read, or whose loss another note tells.
const READ: [&str; 6] = [
    "KHR_lights_punctual",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    INSTANCING,
    "KHR_materials_emissive_strength",
    "KHR_animation_pointer",
];
/// Extensions without which a file looks the same, if it does not require them.
const OPTIONAL: [&str; 6] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_texture_basisu",
    "EXT_texture_webp",
    "MSFT_texture_dds",
    "KHR_xmp_json_ld",
];
/// Extensions of materials that change more than their gloss.
const NOT_GLOSS: [&str; 3] = ["KHR_materials_unlit", "KHR_materials_variants", "KHR_materials_pbrSpecularGlossiness"];

/// Document of a glTF file, and what was taken out of it.
pub struct GltfJson {
    pub document: gltf::Document,
    /// Binary chunk.
    pub blob: Option<Vec<u8>>,
    /// Instances of nodes, by the index of the node.
    pub instances: HashMap<usize, Instances>,
    /// Parts that are not shown, in words.
    pub notes: Vec<String>,
}

/// Indices of the accessors that transform the instances of a node.
#[derive(Clone, Copy, Debug)]
pub struct Instances {
    pub translation: Option<usize>,
    pub rotation: Option<usize>,
    pub scale: Option<usize>,
}

impl GltfJson {
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        let (json, blob) = if bytes.starts_with(b"glTF") {
            let parts = gltf::Glb::from_slice(bytes).map_err(|error| gltf_problem(&error))?;
            (parts.json, parts.bin.map(Cow::into_owned))
        } else if begins_as_json(bytes) {
            (Cow::Borrowed(bytes), None)
        } else {
            return Err(format!("not a glTF file; expected {WHOLE}"));
        };
        let mut json: Value = json::decode(Path::new(""), &json).map_err(|error| json_problem(&error))?;
        let mut notes = Vec::new();
        check_extensions(&mut json, &mut notes)?;
        if let Some(file) = json.as_object_mut()
            && file
                .remove("animations")
                .is_some_and(|animations| animations.as_array().is_some_and(|all| !all.is_empty()))
        {
            notes.push("animations are not played: what moves rests".into());
        }
        let mut unread = BTreeSet::new();
        let instances = instances(&json, &mut unread);
        remove_unread_attributes(&mut json, &mut unread);
        if !unread.is_empty() {
            notes.push(format!("attributes of other programs are not read: {}", listed(&unread)));
        }
        remove_extras(&mut json);
        let root = json::from_value(json).map_err(field_problem)?;
        let document = gltf::Document::from_json(root).map_err(|error| gltf_problem(&error))?;
        Ok(Self { document, blob, instances, notes })
    }
}

/// True if an object begins, or a mark of a Unicode text.
fn begins_as_json(bytes: &[u8]) -> bool {
    let first = bytes.iter().find(|byte| !byte.is_ascii_whitespace());
    matches!(first, Some(b'{' | 0xef | 0xfe | 0xff))
}

/// Refuses a file that requires an extension that is not read, and notes those that it uses. The reader then sees none as
/// required.
fn check_extensions(json: &mut Value, notes: &mut Vec<String>) -> Result<(), String> {
    let names = |list: &str| -> BTreeSet<String> {
        let list = json.get(list).and_then(Value::as_array);
        list.into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
    };
    let is_material = |name: &String| name.starts_with("KHR_materials_");
    let is_read = |name: &String| READ.contains(&name.as_str());
    if let Some(unknown) = names("extensionsRequired").iter().find(|name| !is_read(name) && !is_material(name)) {
        let expected = match unknown.contains("compression") || unknown.contains("texture") {
            true => "an export without compression of meshes, with PNG or JPEG images",
            false => "an export without it",
        };
        return Err(format!(
            "needs the extension {}, which haze does not read; expected {expected}",
            one_line(unknown)
        ));
    }
    let is_unread = |name: &String| !is_read(name) && !OPTIONAL.contains(&name.as_str());
    let unread = names("extensionsUsed").into_iter().filter(is_unread);
    let (gloss, others): (BTreeSet<_>, BTreeSet<_>) =
        unread.partition(|name| is_material(name) && !NOT_GLOSS.contains(&name.as_str()));
    if !gloss.is_empty() {
        notes.push(format!("all surfaces are matte, without {}", listed(&gloss)));
    }
    if !others.is_empty() {
        notes.push(format!("not read: {}", listed(&others)));
    }
    if let Some(file) = json.as_object_mut() {
        file.remove("extensionsRequired");
    }
    Ok(())
}

/// Instances of all nodes. Adds other attributes that they have to `unread`.
fn instances(json: &Value, unread: &mut BTreeSet<String>) -> HashMap<usize, Instances> {
    let mut instances = HashMap::new();
    let nodes = json.get("nodes").and_then(Value::as_array);
    for (index, node) in nodes.into_iter().flatten().enumerate() {
        let extension = node.get("extensions").and_then(|extensions| extensions.get(INSTANCING));
        let Some(attributes) = extension.and_then(|extension| extension.get("attributes")?.as_object()) else {
            continue;
        };
        let accessor = |name| usize::try_from(attributes.get(name)?.as_u64()?).ok();
        let of_node = Instances {
            translation: accessor("TRANSLATION"),
            rotation: accessor("ROTATION"),
            scale: accessor("SCALE"),
        };
        instances.insert(index, of_node);
        let is_other = |name: &&String| !["TRANSLATION", "ROTATION", "SCALE"].contains(&name.as_str());
        unread.extend(attributes.keys().filter(is_other).cloned());
    }
    instances
}

/// Removes attributes of vertices that glTF does not define: those of the application that wrote the file.
fn remove_unread_attributes(json: &mut Value, unread: &mut BTreeSet<String>) {
    for mesh in list_mut(json, "meshes") {
        for primitive in list_mut(mesh, "primitives") {
            let Some(attributes) = primitive.get_mut("attributes").and_then(Value::as_object_mut) else { continue };
            unread.extend(attributes.keys().filter(|name| !is_defined(name)).cloned());
            attributes.retain(|name, _| is_defined(name));
        }
    }
}

fn list_mut<'a>(json: &'a mut Value, name: &str) -> impl Iterator<Item = &'a mut Value> {
    json.get_mut(name).and_then(Value::as_array_mut).into_iter().flatten()
}

fn is_defined(attribute: &str) -> bool {
    let is_numbered = |kind| {
        let number = attribute.strip_prefix(kind);
        number.is_some_and(|number| number.parse::<u32>().is_ok())
    };
    ["POSITION", "NORMAL", "TANGENT"].contains(&attribute)
        || ["COLOR_", "TEXCOORD_", "JOINTS_", "WEIGHTS_"].into_iter().any(is_numbered)
}

/// Removes data of applications, which may have any form.
fn remove_extras(json: &mut Value) {
    match json {
        Value::Object(fields) => {
            fields.remove("extras");
            fields.values_mut().for_each(remove_extras);
        }
        Value::Array(items) => items.iter_mut().for_each(remove_extras),
        _ => {}
    }
}

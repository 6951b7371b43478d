//! FBX files as text, made of a rig: skeleton, skinned mesh, material. For what reads FBX rigs.

use glam::DVec3;
use std::fmt::Write;
use surefoot::rig::Rig;
use surefoot::rig::nodes::globals;

/// How a file is written.
#[derive(Clone, Copy)]
pub struct Written {
    /// Centimetres a unit, as UnitScaleFactor says.
    pub unit: f64,
    /// Z up instead of Y.
    pub z_up: bool,
    /// With the mesh and its skin.
    pub skin: bool,
    /// Of the joints' names.
    pub prefix: &'static str,
}

pub const CENTIMETRES: Written = Written { unit: 1.0, z_up: false, skin: true, prefix: "" };

struct Text {
    objects: String,
    links: String,
    written: Written,
}

impl Text {
    /// A place in metres, as the file has it.
    fn place(&self, metres: DVec3) -> DVec3 {
        let place = if self.written.z_up { DVec3::new(metres.x, -metres.z, metres.y) } else { metres };
        place * 100.0 / self.written.unit
    }

    fn object(&mut self, kind: &str, id: usize, name: &str, class: &str, sort: &str, within: &str) {
        writeln!(self.objects, "{kind}: {id}, \"{class}::{name}\", \"{sort}\" {{\n{within}\n}}").expect("a string");
    }

    fn link(&mut self, child: usize, parent: usize) {
        writeln!(self.links, "C: \"OO\",{child},{parent}").expect("a string");
    }
}

fn list(numbers: impl IntoIterator<Item = f64>) -> String {
    let numbers: Vec<String> = numbers.into_iter().map(|number| format!("{number:.6}")).collect();
    format!("*{} {{ a: {} }}", numbers.len(), numbers.join(","))
}

fn whole(numbers: impl IntoIterator<Item = i64>) -> String {
    let numbers: Vec<String> = numbers.into_iter().map(|number| number.to_string()).collect();
    format!("*{} {{ a: {} }}", numbers.len(), numbers.join(","))
}

fn moved(place: DVec3) -> [f64; 16] {
    let mut matrix = glam::DMat4::IDENTITY.to_cols_array();
    (matrix[12], matrix[13], matrix[14]) = (place.x, place.y, place.z);
    matrix
}

/// The file of a rig in metres whose joints rest unturned, as the built-in one's do.
pub fn text(rig: &Rig, written: Written) -> String {
    let mut text = Text { objects: String::new(), links: String::new(), written };
    let rest = globals(&rig.nodes, |node| node.local);
    let joints: Vec<usize> = rig.skin_joints();
    let id = |node: usize| 1000 + node;
    for &node in &joints {
        let local = text.place(rig.nodes[node].local.translation);
        let name = format!("{}{}", written.prefix, rig.nodes[node].name.as_deref().unwrap_or_default());
        let place =
            format!("P: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",{},{},{}", local.x, local.y, local.z);
        text.object(
            "Model",
            id(node),
            &name,
            "Model",
            "LimbNode",
            &format!("Version: 232\nProperties70: {{\n{place}\n}}"),
        );
        text.object("NodeAttribute", 2000 + node, &name, "NodeAttribute", "LimbNode", "TypeFlags: \"Skeleton\"");
        text.link(id(node), rig.nodes[node].parent.map_or(0, id));
        text.link(2000 + node, id(node));
    }
    if written.skin {
        mesh(rig, &joints, &mut text, &|node| rest[node].translation);
    }
    let (up, front, sign) = if written.z_up { (2, 1, -1) } else { (1, 2, 1) };
    let int = |name: &str, value: i32| format!("P: \"{name}\", \"int\", \"Integer\", \"\",{value}\n");
    let axes = int("UpAxis", up) + &int("UpAxisSign", 1) + &int("FrontAxis", front) + &int("FrontAxisSign", sign);
    let axes = axes + &int("CoordAxis", 0) + &int("CoordAxisSign", 1);
    format!(
        "; FBX 7.4.0 project file\nFBXHeaderExtension: {{\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}}\n\
         GlobalSettings: {{\nVersion: 1000\nProperties70: {{\n{axes}\
         P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",{}\n}}\n}}\n\
         Objects: {{\n{}}}\nConnections: {{\n{}}}\n",
        written.unit, text.objects, text.links
    )
}

/// One mesh of all parts, with a share for a fifth joint where a vertex has four.
fn mesh(rig: &Rig, joints: &[usize], text: &mut Text, rest: &dyn Fn(usize) -> DVec3) {
    let [geometry, model, material, skin, clusters] = [10, 11, 12, 13, 3000];
    let (mut places, mut corners, mut materials) = (Vec::new(), Vec::new(), Vec::new());
    let mut shares: Vec<Vec<(usize, f64)>> = vec![Vec::new(); rig.nodes.len()];
    for (number, part) in rig.mesh.iter().enumerate() {
        let first = places.len();
        for (vertex, place) in part.positions.iter().enumerate() {
            for (node, share) in part.weights[vertex].iter().filter(|(_, share)| *share > 0.0) {
                shares[*node].push((places.len(), *share));
            }
            places.push(text.place(*place));
            if vertex == 0 {
                for node in joints.iter().take(6) {
                    shares[*node].push((first, 0.01));
                }
            }
        }
        for triangle in part.indices.chunks_exact(3) {
            let [a, b, c] = [triangle[0], triangle[1], triangle[2]].map(|corner| (first + corner as usize) as i64);
            corners.extend([a, b, -c - 1]);
            materials.push(number as i64);
        }
    }
    let within = format!(
        "Vertices: {}\nPolygonVertexIndex: {}\nLayerElementMaterial: 0 {{\nMappingInformationType: \"ByPolygon\"\n\
         ReferenceInformationType: \"IndexToDirect\"\nMaterials: {}\n}}\n\
         Layer: 0 {{\nLayerElement: {{\nType: \"LayerElementMaterial\"\nTypedIndex: 0\n}}\n}}",
        list(places.iter().flat_map(|place| place.to_array())),
        whole(corners),
        whole(materials)
    );
    text.object("Geometry", geometry, "body", "Geometry", "Mesh", &within);
    text.object("Model", model, "body", "Model", "Mesh", "Version: 232");
    text.link(model, 0);
    text.link(geometry, model);
    for number in 0..rig.mesh.len() {
        let colour = "Properties70: {\nP: \"DiffuseColor\", \"Color\", \"\", \"A\",0.25,0.5,0.75\n}";
        text.object("Material", material + 100 * (number + 1), "paint", "Material", "", colour);
        text.link(material + 100 * (number + 1), model);
    }
    text.object("Deformer", skin, "skin", "Deformer", "Skin", "Version: 101");
    text.link(skin, geometry);
    for &node in joints {
        let place = text.place(rest(node));
        let within = format!(
            "Version: 100\nIndexes: {}\nWeights: {}\nTransform: {}\nTransformLink: {}",
            whole(shares[node].iter().map(|(vertex, _)| *vertex as i64)),
            list(shares[node].iter().map(|(_, share)| *share)),
            list(moved(-place)),
            list(moved(place))
        );
        text.object("Deformer", clusters + node, "cluster", "SubDeformer", "Cluster", &within);
        text.link(clusters + node, skin);
        text.link(1000 + node, clusters + node);
    }
}

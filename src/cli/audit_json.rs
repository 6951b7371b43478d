//! Findings as JSON: the fixed keys in their order, then `file`; a waived flag has a `waived` with the reason.

use super::audit::Audited;
use serde_json::{Value, json};

/// One object, or an array of them.
pub fn text(clips: &[Audited], several: bool) -> String {
    let mut objects: Vec<Value> = clips.iter().map(object).collect();
    let value = match several || objects.len() != 1 {
        true => Value::Array(objects),
        false => objects.remove(0),
    };
    // `{:#}` of a JSON value cannot fail.
    format!("{value:#}\n")
}

fn object(clip: &Audited) -> Value {
    let mut value = json!(clip.findings);
    mark(&mut value["flags"], &clip.waived.flags);
    mark(&mut value["clip_flags"], &clip.waived.clip_flags);
    value["file"] = json!(clip.path.display().to_string());
    value
}

fn mark(flags: &mut Value, reasons: &[Option<String>]) {
    for (flag, reason) in flags.as_array_mut().into_iter().flatten().zip(reasons) {
        if let Some(reason) = reason {
            flag["waived"] = json!(reason);
        }
    }
}

//! The page of an audit: one HTML file that needs no network, drawn from embedded data by its own script.
//!
//! The page's shell, style and scripts are text files in `report/`; the data are what [`clip_json`] says of each clip. Whatever a file
//! is called, its name stays text: markup is escaped here, and the scripts only ever set text. A content security policy bars the rest.

pub use super::report_data::{ClipView, clip_json};

use super::text::escaped;

/// Bytes that the clips of a page may take together.
pub const MOST_BYTES: usize = 9_000_000;

const SHELL: &str = include_str!("report/page.html");
const STYLE: &str = include_str!("report/page.css");
/// In the order in which they need one another.
const SCRIPTS: [&str; 6] = [
    include_str!("report/data.js"),
    include_str!("report/stage.js"),
    include_str!("report/top_view.js"),
    include_str!("report/timeline.js"),
    include_str!("report/lists.js"),
    include_str!("report/page.js"),
];

/// The page of those clips, each as [`clip_json`] gives it.
pub fn report_page(title: &str, clips: &[String]) -> String {
    let mut data = String::with_capacity(clips.iter().map(|clip| clip.len() + 1).sum::<usize>() + 2);
    data.push('[');
    data.push_str(&clips.join(","));
    data.push(']');
    let scripts = SCRIPTS.join("\n");
    let texts =
        [("title", escaped(title)), ("style", STYLE.to_owned()), ("data", in_script(&data)), ("script", scripts)];
    // Marks are looked for in the shell alone, not in what takes their places.
    let mut pieces = SHELL.split("{{");
    let mut page = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (mark, rest) = piece.split_once("}}").unwrap_or((piece, ""));
        page.push_str(texts.iter().find(|(name, _)| *name == mark).map_or("", |(_, text)| text));
        page.push_str(rest);
    }
    page
}

/// JSON that cannot end the script element that it stands in: these letters occur in strings only, where an escape means the same.
fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hostile_name_stays_text() {
        let name = "</script><img src=x onerror=alert(1)>&\"'{{data}}{{style}}";
        let clip = serde_json::json!({ "name": name }).to_string();
        let page = report_page(name, &[clip]);
        assert_eq!(page.matches("</script>").count(), SHELL.matches("</script>").count());
        assert!(!page.contains("<img"), "no element of the name's");
        let start = page.find("id=\"data\">").expect("the data") + "id=\"data\">".len();
        let end = start + page[start..].find("</script>").expect("its end");
        let data: serde_json::Value = serde_json::from_str(&page[start..end]).expect("JSON");
        assert_eq!(data[0]["name"], name, "as it was");
    }

    #[test]
    fn the_page_asks_the_network_for_nothing() {
        let page = report_page("a", &[]);
        for way_out in
            ["http://", "https://", "src=", "href=", "@import", "url(", "fetch(", "XMLHttpRequest", "innerHTML"]
        {
            assert!(!page.contains(way_out), "{way_out}");
        }
        assert!(page.contains("default-src 'none'"), "and may not");
    }
}

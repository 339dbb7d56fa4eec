//! A page as one self-contained HTML file.

use crate::report::page::Histogram;
use crate::report::page::Page;
use crate::report::page::Plate;
use crate::report::page::Table;
use std::fmt::Write;

const STYLE: &str = "
body{font:15px/1.45 system-ui,sans-serif;color:#1c2730;max-width:1180px;margin:2em auto;padding:0 1em}
h1{font-size:1.7em;margin-bottom:.1em} h2{font-size:1.15em;margin-top:2em;border-bottom:1px solid #cdd6dc}
.verdict{padding:.5em .8em;border-radius:6px;background:#e3f3ea} .broken{background:#fbe3e1}
figure{margin:1em 0} figure img{width:100%;border:1px solid #cdd6dc;border-radius:4px}
figcaption{color:#53626d;font-size:.9em} .side{display:grid;grid-template-columns:repeat(auto-fit,minmax(330px,1fr));gap:1em}
table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:.9em} .wide{overflow-x:auto}
th,td{padding:.2em .7em;text-align:right;border-bottom:1px solid #e6ebee} th{color:#53626d;font-weight:600}
th:first-child,td:first-child{text-align:left} p.note{color:#53626d;margin:.3em 0}
svg text{font:11px system-ui,sans-serif;fill:#53626d}
";

/// The page as HTML, complete in itself.
pub fn html(page: &Page) -> String {
    let mut out = String::new();
    let class = if page.holds {
        "verdict"
    } else {
        "verdict broken"
    };
    let title = escape(&page.title);
    write_to(
        &mut out,
        format_args!(
            "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>{title}</title><style>{STYLE}</style>\n\
         <h1>{title}</h1>\n<p class=\"{class}\">{}</p>\n",
            escape(&page.verdict)
        ),
    );
    if let Some((first, others)) = page.plates.split_first() {
        plate(&mut out, first);
        out.push_str("<div class=\"side\">\n");
        for other in others {
            plate(&mut out, other);
        }
        out.push_str("</div>\n");
    }
    out.push_str("<h2>Distributions</h2>\n<div class=\"side\">\n");
    for it in &page.histograms {
        histogram(&mut out, it);
    }
    out.push_str("</div>\n");
    for it in &page.tables {
        table(&mut out, it);
    }
    out.push_str("</html>\n");
    out
}

fn plate(out: &mut String, plate: &Plate) {
    let image = base64(&plate.png);
    let caption = escape(&plate.caption);
    write_to(
        out,
        format_args!(
            "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{image}\"><figcaption>{caption}</figcaption></figure>\n"
        ),
    );
}

fn histogram(out: &mut String, it: &Histogram) {
    let (width, height) = (340.0, 130.0);
    let most = it.counts.iter().copied().max().unwrap_or(0).max(1) as f64;
    let bin = width / it.counts.len().max(1) as f64;
    write_to(
        out,
        format_args!(
            "<figure><svg viewBox=\"0 0 {width} {}\" width=\"100%\">\n",
            height + 20.0
        ),
    );
    for (n, &count) in it.counts.iter().enumerate() {
        // Square root scale: a tail of a few cells in a million still shows.
        let tall = height * (count as f64 / most).sqrt();
        let (x, y) = (n as f64 * bin, height - tall);
        write_to(
            out,
            format_args!(
                "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{tall:.1}\" fill=\"#4f9a8b\"><title>{count}</title></rect>\n",
                bin - 1.0
            ),
        );
    }
    for (at, value, anchor) in [(0.0, it.from, "start"), (width, it.to, "end")] {
        write_to(
            out,
            format_args!(
                "<text x=\"{at}\" y=\"{}\" text-anchor=\"{anchor}\">{value}</text>",
                height + 15.0
            ),
        );
    }
    write_to(
        out,
        format_args!(
            "</svg><figcaption>{} (heights by square root)</figcaption></figure>\n",
            escape(&it.title)
        ),
    );
}

fn table(out: &mut String, it: &Table) {
    write_to(out, format_args!("<h2>{}</h2>\n", escape(&it.title)));
    if !it.note.is_empty() {
        write_to(
            out,
            format_args!("<p class=\"note\">{}</p>\n", escape(&it.note)),
        );
    }
    out.push_str("<div class=\"wide\"><table><tr>");
    for name in &it.head {
        write_to(out, format_args!("<th>{}</th>", escape(name)));
    }
    out.push_str("</tr>\n");
    for row in &it.rows {
        out.push_str("<tr>");
        for cell in row {
            write_to(out, format_args!("<td>{}</td>", escape(cell)));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</table></div>\n");
}

fn write_to(out: &mut String, what: std::fmt::Arguments) {
    out.write_fmt(what)
        .expect("writing to a string cannot fail");
}

/// `text` with the characters that HTML gives a meaning written out: names come from users' files.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            other => out.push(other),
        }
    }
    out
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |n: usize| u32::from(three.get(n).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for n in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * n)) as usize & 63];
            out.push(if n <= three.len() {
                letter as char
            } else {
                '='
            });
        }
    }
    out
}

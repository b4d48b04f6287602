//! Texts of attribute tables in the code pages of their time.

use crate::SurveyError;

/// A code page: how the bytes from 128 on are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CodePage {
    Utf8,
    /// UTF-8 where that is what the bytes are, Windows' western page otherwise: where a file says nothing.
    Unsaid,
    Latin1,
    /// The characters of the last bytes; 128 or 96 of them, what lies below stands for itself.
    Table(&'static str),
}

impl CodePage {
    /// The page that a `.cpg` file names.
    pub(super) fn named(text: &[u8], name: &str) -> Result<Self, SurveyError> {
        let text = String::from_utf8_lossy(text);
        let key = text.trim_matches('\u{feff}').trim().to_lowercase().replace(['-', '_', ' '], "");
        let number = ["windows", "ansi", "oem", "cp", "ibm"].iter().fold(key.as_str(), |k, p| k.strip_prefix(p).unwrap_or(k));
        Ok(match (key.as_str(), number) {
            ("", _) => Self::Unsaid,
            ("utf8", _) | (_, "65001") => Self::Utf8,
            ("iso88591" | "88591" | "latin1", _) | (_, "28591") => Self::Latin1,
            ("iso88592" | "88592" | "latin2", _) | (_, "28592") => Self::Table(ISO_8859_2),
            ("iso885915" | "885915" | "latin9", _) | (_, "28605") => Self::Table(ISO_8859_15),
            (_, "1250") => Self::Table(CP1250),
            (_, "1251") => Self::Table(CP1251),
            (_, "1252") => Self::Table(CP1252),
            (_, "852") => Self::Table(CP852),
            (_, "850") => Self::Table(CP850),
            (_, "437") => Self::Table(CP437),
            _ => {
                return Err(SurveyError::Unsupported {
                    name: name.to_owned(),
                    feature: format!("texts in the code page \"{}\"", crate::lines::short(text.trim())),
                    fix: "export it again with UTF-8 as encoding",
                });
            }
        })
    }

    /// The page that the language byte of a `.dbf` header means.
    pub(super) fn of_language_byte(byte: u8) -> Self {
        match byte {
            0x01 => Self::Table(CP437),
            0x02 => Self::Table(CP850),
            0x03 | 0x58 | 0x59 => Self::Table(CP1252),
            0x1F | 0x22 | 0x23 | 0x40 | 0x64 | 0x87 => Self::Table(CP852),
            0xC8 => Self::Table(CP1250),
            0xC9 => Self::Table(CP1251),
            _ => Self::Unsaid,
        }
    }

    /// Reads a text; bytes without meaning become U+FFFD.
    pub(super) fn text(self, bytes: &[u8]) -> String {
        if let (true, Ok(ascii)) = (bytes.is_ascii(), core::str::from_utf8(bytes)) {
            return ascii.to_owned();
        }
        let table = match self {
            Self::Utf8 => return String::from_utf8_lossy(bytes).into_owned(),
            Self::Unsaid => match core::str::from_utf8(bytes) {
                Ok(text) => return text.to_owned(),
                Err(_) => CP1252,
            },
            Self::Latin1 => "",
            Self::Table(table) => table,
        };
        let upper: Vec<char> = table.chars().collect();
        let from = 256 - upper.len();
        let read = |&byte: &u8| usize::from(byte).checked_sub(from).and_then(|i| upper.get(i).copied()).unwrap_or(char::from(byte));
        bytes.iter().map(read).collect()
    }
}

const CP1250: &str = "€\u{fffd}‚\u{fffd}„…†‡\u{fffd}‰Š‹ŚŤŽŹ\u{fffd}‘’“”•–—\u{fffd}™š›śťžź\u{a0}ˇ˘Ł¤Ą¦§¨©Ş«¬\u{ad}®Ż°±˛ł´µ¶·¸ąş»Ľ˝ľżŔ\
     ÁÂĂÄĹĆÇČÉĘËĚÍÎĎĐŃŇÓÔŐÖ×ŘŮÚŰÜÝŢßŕáâăäĺćçčéęëěíîďđńňóôőö÷řůúűüýţ˙";
const CP1251: &str = "ЂЃ‚ѓ„…†‡€‰Љ‹ЊЌЋЏђ‘’“”•–—\u{fffd}™љ›њќћџ\u{a0}ЎўЈ¤Ґ¦§Ё©Є«¬\u{ad}®Ї°±Ііґµ¶·ё№є»јЅѕїАБВГДЕЖЗИЙКЛМНОПРСТУФХЦЧШЩЪЫЬ\
     ЭЮЯабвгдежзийклмнопрстуфхцчшщъыьэюя";
const CP1252: &str = "€\u{fffd}‚ƒ„…†‡ˆ‰Š‹Œ\u{fffd}Ž\u{fffd}\u{fffd}‘’“”•–—˜™š›œ\u{fffd}žŸ\u{a0}¡¢£¤¥¦§¨©ª«¬\u{ad}®¯°±²³´µ¶·¸¹º»¼½¾¿À\
     ÁÂÃÄÅÆÇÈÉÊËÌÍÎÏÐÑÒÓÔÕÖ×ØÙÚÛÜÝÞßàáâãäåæçèéêëìíîïðñòóôõö÷øùúûüýþÿ";
const CP852: &str = "ÇüéâäůćçłëŐőîŹÄĆÉĹĺôöĽľŚśÖÜŤťŁ×čáíóúĄąŽžĘę¬źČş«»░▒▓│┤ÁÂĚŞ╣║╗╝Żż┐└┴┬├─┼Ăă╚╔╩╦╠═╬¤đĐĎËďŇÍÎě┘┌█▄ŢŮ▀ÓßÔŃńňŠšŔÚŕŰýÝ\
     ţ´\u{ad}˝˛ˇ˘§÷¸°¨˙űŘř■\u{a0}";
const CP850: &str = "ÇüéâäàåçêëèïîìÄÅÉæÆôöòûùÿÖÜø£Ø×ƒáíóúñÑªº¿®¬½¼¡«»░▒▓│┤ÁÂÀ©╣║╗╝¢¥┐└┴┬├─┼ãÃ╚╔╩╦╠═╬¤ðÐÊËÈıÍÎÏ┘┌█▄¦Ì▀ÓßÔÒõÕµþÞÚÛÙýÝ\
     ¯´\u{ad}±‗¾¶§÷¸°¨·¹³²■\u{a0}";
const CP437: &str = "ÇüéâäàåçêëèïîìÄÅÉæÆôöòûùÿÖÜ¢£¥₧ƒáíóúñÑªº¿⌐¬½¼¡«»░▒▓│┤╡╢╖╕╣║╗╝╜╛┐└┴┬├─┼╞╟╚╔╩╦╠═╬╧╨╤╥╙╘╒╓╫╪┘┌█▄▌▐▀αßΓπΣσµτΦΘΩδ∞φ\
     ε∩≡±≥≤⌠⌡÷≈°∙·√ⁿ²■\u{a0}";
const ISO_8859_2: &str =
    "\u{a0}Ą˘Ł¤ĽŚ§¨ŠŞŤŹ\u{ad}ŽŻ°ą˛ł´ľśˇ¸šşťź˝žżŔÁÂĂÄĹĆÇČÉĘËĚÍÎĎĐŃŇÓÔŐÖ×ŘŮÚŰÜÝŢßŕáâăäĺćçčéęëěíîďđńňóôőö÷řůúűüýţ˙";
const ISO_8859_15: &str =
    "\u{a0}¡¢£€¥Š§š©ª«¬\u{ad}®¯°±²³Žµ¶·ž¹º»ŒœŸ¿ÀÁÂÃÄÅÆÇÈÉÊËÌÍÎÏÐÑÒÓÔÕÖ×ØÙÚÛÜÝÞßàáâãäåæçèéêëìíîïðñòóôõö÷øùúûüýþÿ";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn czech_names_read_the_same_from_every_page() {
        for (page, bytes) in [
            ("UTF-8", &b"P\xC5\x99\xC3\xADbor"[..]),
            ("windows-1250", b"P\xF8\xEDbor"),
            ("ISO-8859-2", b"P\xF8\xEDbor"),
            ("OEM 852", b"P\xFD\xA1bor"),
        ] {
            assert_eq!(CodePage::named(page.as_bytes(), "x").unwrap().text(bytes), "Příbor", "{page}");
        }
    }

    #[test]
    fn every_table_ends_at_the_last_byte() {
        for table in [CP1250, CP1251, CP1252, CP852, CP850, CP437] {
            assert_eq!(table.chars().count(), 128);
        }
        for table in [ISO_8859_2, ISO_8859_15] {
            assert_eq!(table.chars().count(), 96);
        }
        assert_eq!(CodePage::Table(CP1252).text(b"\x80 A"), "€ A");
    }

    #[test]
    fn unsaid_is_utf8_if_it_can_be_and_an_unknown_page_is_an_error() {
        assert_eq!(CodePage::Unsaid.text("été".as_bytes()), "été");
        assert_eq!(CodePage::Unsaid.text(b"\xe9t\xe9"), "été");
        let error = CodePage::named(b"Big5", "a.cpg").unwrap_err().to_string();
        assert!(error.contains("a.cpg") && error.contains("Big5") && error.contains("UTF-8"), "{error}");
    }
}

use core::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// A number, or a formula of parameters: `1.2`, `"height / 3 - 0.1"`, `"max(2, width * 0.4)"`.
///
/// Numbers, names, `+ - * /`, comparisons `< > <= >=` (1 where they hold, else 0), parentheses and the functions `abs`, `floor`,
/// `round`, `sqrt`, `sin`, `cos`, `tan` (of degrees), `min` and `max`. The same bits on every platform.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    text: Box<str>,
    root: Node,
}

#[derive(Debug, Clone, PartialEq)]
enum Node {
    Number(f64),
    Name(Box<str>),
    Negative(Box<Node>),
    Pair(Operator, Box<[Node; 2]>),
    Call(Function, Vec<Node>),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Operator {
    Plus,
    Minus,
    Times,
    Over,
    Less,
    More,
    AtMost,
    AtLeast,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Function {
    Abs,
    Floor,
    Round,
    Sqrt,
    Sin,
    Cos,
    Tan,
    Min,
    Max,
}

const FUNCTIONS: [(&str, Function, usize); 9] = [
    ("abs", Function::Abs, 1),
    ("floor", Function::Floor, 1),
    ("round", Function::Round, 1),
    ("sqrt", Function::Sqrt, 1),
    ("sin", Function::Sin, 1),
    ("cos", Function::Cos, 1),
    ("tan", Function::Tan, 1),
    ("min", Function::Min, 2),
    ("max", Function::Max, 2),
];

/// Deepest nesting of a formula.
const DEEPEST: usize = 48;

/// Why a text is no formula.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is no formula: {message} at character {at}")]
pub struct FormulaError {
    /// The text.
    pub text: String,
    /// What is wrong.
    pub message: String,
    /// Where, in characters from 1.
    pub at: usize,
}

impl Formula {
    /// A number.
    #[must_use]
    pub fn number(value: f64) -> Self {
        Self { text: value.to_string().into(), root: Node::Number(value) }
    }

    /// Reads a formula.
    ///
    /// # Errors
    /// [`FormulaError`] with the place of the first mistake.
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        let mut reader = Reader { text, at: 0, depth: 0 };
        let root = reader.comparison()?;
        match reader.peek() {
            None => Ok(Self { text: text.into(), root }),
            Some(c) => Err(reader.error(format!("`{c}` is not expected here"))),
        }
    }

    /// Its value where names stand for numbers.
    ///
    /// # Errors
    /// The first name that stands for nothing.
    pub fn value(&self, named: &dyn Fn(&str) -> Option<f64>) -> Result<f64, &str> {
        self.root.value(named)
    }
}

impl fmt::Display for Formula {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Node {
    fn value(&self, named: &dyn Fn(&str) -> Option<f64>) -> Result<f64, &str> {
        Ok(match self {
            Self::Number(value) => *value,
            Self::Name(name) => named(name).ok_or(&**name)?,
            Self::Negative(of) => -of.value(named)?,
            Self::Pair(operator, pair) => {
                let (a, b) = (pair[0].value(named)?, pair[1].value(named)?);
                match operator {
                    Operator::Plus => a + b,
                    Operator::Minus => a - b,
                    Operator::Times => a * b,
                    Operator::Over => a / b,
                    Operator::Less => f64::from(a < b),
                    Operator::More => f64::from(a > b),
                    Operator::AtMost => f64::from(a <= b),
                    Operator::AtLeast => f64::from(a >= b),
                }
            }
            Self::Call(function, of) => {
                let arg = |i: usize| of.get(i).map_or(Ok(0.0), |node| node.value(named));
                let (a, b) = (arg(0)?, arg(1)?);
                match function {
                    Function::Abs => a.abs(),
                    Function::Floor => libm::floor(a),
                    Function::Round => libm::round(a),
                    Function::Sqrt => libm::sqrt(a),
                    Function::Sin => libm::sin(a.to_radians()),
                    Function::Cos => libm::cos(a.to_radians()),
                    Function::Tan => libm::tan(a.to_radians()),
                    Function::Min => a.min(b),
                    Function::Max => a.max(b),
                }
            }
        })
    }
}

/// Reads a formula by recursive descent, loosest operators first.
struct Reader<'a> {
    text: &'a str,
    /// In bytes.
    at: usize,
    depth: usize,
}

impl Reader<'_> {
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    fn error(&self, message: String) -> FormulaError {
        FormulaError { text: self.text.to_owned(), message, at: self.text[..self.at].chars().count() + 1 }
    }

    /// Takes the first of some signs that comes next.
    fn take(&mut self, signs: &[(&str, Operator)]) -> Option<Operator> {
        self.peek();
        let (sign, operator) = signs.iter().find(|(sign, _)| self.text[self.at..].starts_with(sign))?;
        self.at += sign.len();
        Some(*operator)
    }

    fn comparison(&mut self) -> Result<Node, FormulaError> {
        let signs = [("<=", Operator::AtMost), (">=", Operator::AtLeast), ("<", Operator::Less), (">", Operator::More)];
        self.row(&signs, |reader| reader.row(&[("+", Operator::Plus), ("-", Operator::Minus)], Self::product))
    }

    fn product(&mut self) -> Result<Node, FormulaError> {
        self.row(&[("*", Operator::Times), ("/", Operator::Over)], Self::factor)
    }

    fn row(
        &mut self,
        signs: &[(&str, Operator)],
        next: impl Fn(&mut Self) -> Result<Node, FormulaError>,
    ) -> Result<Node, FormulaError> {
        let mut left = next(self)?;
        let mut terms = 0;
        while let Some(operator) = self.take(signs) {
            terms += 1;
            if terms > DEEPEST {
                return Err(self.error("the formula is too long".to_owned()));
            }
            left = Node::Pair(operator, Box::new([left, next(self)?]));
        }
        Ok(left)
    }

    fn factor(&mut self) -> Result<Node, FormulaError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.error("the formula is nested too deeply".to_owned()));
        }
        let node = match self.peek() {
            Some('-') => {
                self.at += 1;
                Node::Negative(Box::new(self.factor()?))
            }
            Some('(') => {
                self.at += 1;
                let inner = self.comparison()?;
                self.expect(')')?;
                inner
            }
            Some(c) if c.is_ascii_digit() || c == '.' => {
                let digits = self.word(|c| c.is_ascii_digit() || c == '.');
                let value = digits.parse().map_err(|_| self.error(format!("`{digits}` is no number")))?;
                self.at += digits.len();
                Node::Number(value)
            }
            Some(c) if c.is_ascii_alphabetic() || c == '_' => self.name()?,
            Some(c) => return Err(self.error(format!("a number or name is expected in place of `{c}`"))),
            None => return Err(self.error("a number or name is expected".to_owned())),
        };
        self.depth -= 1;
        Ok(node)
    }

    fn word(&self, is_part: impl Fn(char) -> bool) -> String {
        self.text[self.at..].chars().take_while(|&c| is_part(c)).collect()
    }

    fn name(&mut self) -> Result<Node, FormulaError> {
        let name = self.word(|c| c.is_ascii_alphanumeric() || c == '_');
        let start = self.at;
        self.at += name.len();
        if self.peek() != Some('(') {
            return Ok(Node::Name(name.into()));
        }
        let Some(&(_, function, count)) = FUNCTIONS.iter().find(|(known, ..)| *known == name) else {
            self.at = start;
            let known = FUNCTIONS.map(|(known, ..)| known).join(", ");
            return Err(self.error(format!("there is no function `{name}`; there are {known}")));
        };
        self.at += 1;
        let mut of = vec![self.comparison()?];
        while of.len() < count {
            self.expect(',')?;
            of.push(self.comparison()?);
        }
        self.expect(')')?;
        Ok(Node::Call(function, of))
    }

    fn expect(&mut self, sign: char) -> Result<(), FormulaError> {
        if self.peek() == Some(sign) {
            self.at += sign.len_utf8();
            return Ok(());
        }
        Err(self.error(format!("`{sign}` is expected")))
    }
}

impl Serialize for Formula {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.root {
            Node::Number(value) => serializer.serialize_f64(value),
            _ => serializer.serialize_str(&self.text),
        }
    }
}

impl<'de> Deserialize<'de> for Formula {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl de::Visitor<'_> for Visitor {
            type Value = Formula;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or a formula in quotes")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Formula, E> {
                Ok(Formula::number(value))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Formula, E> {
                Ok(Formula::number(value as f64))
            }

            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Formula, E> {
                Ok(Formula::number(value as f64))
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<Formula, E> {
                Formula::parse(text).map_err(E::custom)
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        let named = |name: &str| match name {
            "height" => Some(12.0),
            "r_2" => Some(0.5),
            _ => None,
        };
        let formula = Formula::parse(text).unwrap_or_else(|e| panic!("{e}"));
        formula.value(&named).unwrap_or_else(|name| panic!("no {name}"))
    }

    #[test]
    fn formulas_follow_arithmetic() {
        assert_eq!(value("1 + 2 * 3"), 7.0);
        assert_eq!(value("(1 + 2) * 3 - -1"), 10.0);
        assert_eq!(value("height / 4 / 3"), 1.0);
        assert_eq!(value("10 - 3 - 2"), 5.0);
        assert_eq!(value("max(r_2, min(height, 3)) + floor(2.7)"), 5.0);
        assert!((value("2 * sin(30) + sqrt(9) + cos(60)") - 4.5).abs() < 1e-12);
        assert_eq!(value("height > 10"), 1.0);
        assert_eq!(value("2 * (height <= 10)"), 0.0);
        assert_eq!(value(".5 * 4."), 2.0);
    }

    #[test]
    fn mistakes_show_their_place() {
        for (text, at, part) in [
            ("1 + ", 5, "expected"),
            ("2 * (3", 7, "`)`"),
            ("4 height", 3, "`h`"),
            ("sine(3)", 1, "no function `sine`"),
            ("min(3)", 6, "`,`"),
            ("1.2.3", 1, "no number"),
            ("3 € 4", 3, "`€`"),
            ("", 1, "expected"),
        ] {
            let error = Formula::parse(text).expect_err(text);
            assert!(error.at == at && error.message.contains(part), "{text}: {error}");
        }
        assert_eq!(Formula::parse("width * 2").map(|f| f.value(&|_| None).map_err(str::to_owned)), Ok(Err("width".to_owned())));
    }

    #[test]
    fn no_formula_overflows_the_stack() {
        for text in ["(".repeat(100_000), "-".repeat(100_000), "1+".repeat(100_000)] {
            assert!(Formula::parse(&text).is_err());
        }
    }

    #[test]
    fn numbers_and_texts_are_read_and_written_as_they_are() {
        let read: Vec<Formula> = crate::file::parse("[1, -2.5, \"height * 2\"]", "test").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(read[0], Formula::number(1.0));
        assert_eq!(read[2].to_string(), "height * 2");
        let text = crate::file::to_text(&read).unwrap_or_default();
        assert_eq!(crate::file::parse::<Vec<Formula>>(&text, "again").map_err(|e| e.to_string()), Ok(read));
        let wrong = crate::file::parse::<Vec<Formula>>("[\n 1,\n \"2 *\"]", "test").expect_err("no formula");
        assert!((wrong.line, wrong.message.contains("`2 *` is no formula")) == (3, true), "{wrong}");
    }
}

//! From the text of a law to its tape, with the position of every error.
//!
//! sum = product (("+" | "-") product)*;  product = signed (("*" | "/") signed)*;
//! signed = "-" signed | power;  power = atom ("^" signed)?;
//! atom = number | name | name "(" sum ("," sum)? ")" | "(" sum ")".

use thiserror::Error;

use super::tape::{DEEPEST, Function, LONGEST, Operation, Tape, Variable};

/// Deepest nesting of parentheses, signs and powers that the parser follows.
const DEEPEST_NESTING: usize = 64;
/// Greatest whole exponent that is multiplied out.
const GREATEST_EXPONENT: f64 = 16.0;

/// What is wrong with the text of a law; `at` is the byte position in it.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LawError {
    /// A character that no law has.
    #[error("`{found}` means nothing in a law")]
    Character {
        /// Byte position.
        at: usize,
        /// The character.
        found: char,
    },
    /// Something else was needed here.
    #[error("expected {expected}, found {found}")]
    Unexpected {
        /// Byte position.
        at: usize,
        /// What the grammar needs.
        expected: &'static str,
        /// What stands there.
        found: String,
    },
    /// A name that is neither a variable, a parameter nor a function.
    #[error(
        "`{name}` is unknown: variables are {variables}, parameters {}, functions {functions}",
        if parameters.is_empty() { "none" } else { parameters }
    )]
    Name {
        /// Byte position.
        at: usize,
        name: String,
        /// The variables there are.
        variables: String,
        /// The parameters that the effect declares.
        parameters: String,
        /// The functions there are.
        functions: String,
    },
    /// The law is longer or deeper than allowed.
    #[error("the law is too {what}: at most {most}")]
    TooLarge {
        /// Byte position.
        at: usize,
        /// Long, or deeply nested.
        what: &'static str,
        /// The limit.
        most: usize,
    },
}

impl LawError {
    /// Byte position in the text of the law.
    pub fn at(&self) -> usize {
        match self {
            Self::Character { at, .. }
            | Self::Unexpected { at, .. }
            | Self::Name { at, .. }
            | Self::TooLarge { at, .. } => *at,
        }
    }
}

/// Variables of an expression in time alone.
pub(super) const TIME: [(&str, Variable); 1] = [("t", Variable::Time)];
/// Variables of a law of the drive.
pub(super) const DRIVE: [(&str, Variable); 7] = [
    ("i", Variable::Current),
    ("omega", Variable::Speed),
    ("v", Variable::Speed),
    ("theta", Variable::Position),
    ("x", Variable::Position),
    ("u", Variable::Input),
    ("t", Variable::Time),
];
const TWO_ARGUMENTS: [(&str, Operation); 2] =
    [("min", Operation::Least), ("max", Operation::Greatest)];

#[derive(Debug, Clone, PartialEq)]
enum Token {
    Number(f64),
    Name(String),
    Mark(char),
    End,
}

impl Token {
    fn shown(&self) -> String {
        match self {
            Self::Number(value) => format!("the number {value}"),
            Self::Name(name) => format!("`{name}`"),
            Self::Mark(mark) => format!("`{mark}`"),
            Self::End => "the end".to_owned(),
        }
    }
}

/// Splits the text into tokens with their positions; the last one is the end.
fn tokens(text: &str) -> Result<Vec<(usize, Token)>, LawError> {
    let mut found = Vec::new();
    let mut rest = text.char_indices().peekable();
    while let Some(&(at, c)) = rest.peek() {
        if c.is_whitespace() {
            rest.next();
        } else if c.is_ascii_digit() || c == '.' {
            let end = number_end(text, at);
            let value = text[at..end].parse().map_err(|_| LawError::Unexpected {
                at,
                expected: "a number",
                found: format!("`{}`", &text[at..end]),
            })?;
            found.push((at, Token::Number(value)));
            while rest.peek().is_some_and(|&(k, _)| k < end) {
                rest.next();
            }
        } else if c.is_alphabetic() || c == '_' {
            let mut name = String::new();
            while let Some(&(_, c)) = rest.peek().filter(|(_, c)| c.is_alphanumeric() || *c == '_')
            {
                name.push(c);
                rest.next();
            }
            found.push((at, Token::Name(name)));
        } else if "+-*/^(),".contains(c) {
            found.push((at, Token::Mark(c)));
            rest.next();
        } else {
            return Err(LawError::Character { at, found: c });
        }
    }
    found.push((text.len(), Token::End));
    Ok(found)
}

/// End of the number that starts at `at`: digits, a point, an exponent with its sign.
fn number_end(text: &str, at: usize) -> usize {
    let bytes = text.as_bytes();
    let digits = |mut k: usize| {
        while bytes.get(k).is_some_and(|b| b.is_ascii_digit() || *b == b'.') {
            k += 1;
        }
        k
    };
    let end = digits(at);
    if !matches!(bytes.get(end), Some(b'e' | b'E')) {
        return end;
    }
    let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
    let exponent = digits(end + 1 + sign);
    if exponent > end + 1 + sign { exponent } else { end }
}

/// Parses the text into a tape.
pub(super) fn parse(
    text: &str,
    parameters: &[String],
    variables: &[(&str, Variable)],
) -> Result<Tape, LawError> {
    let tokens = tokens(text)?;
    let mut parser = Parser { tokens, next: 0, parameters, variables, tape: Vec::new(), depth: 0 };
    parser.sum(0)?;
    match parser.peek() {
        (_, Token::End) => Ok(Tape(parser.tape)),
        _ => Err(parser.unexpected("an operator or the end")),
    }
}

struct Parser<'a> {
    tokens: Vec<(usize, Token)>,
    next: usize,
    parameters: &'a [String],
    variables: &'a [(&'a str, Variable)],
    tape: Vec<Operation>,
    /// Values on the stack after the operations so far.
    depth: usize,
}

impl Parser<'_> {
    fn peek(&self) -> &(usize, Token) {
        &self.tokens[self.next.min(self.tokens.len() - 1)]
    }

    fn unexpected(&self, expected: &'static str) -> LawError {
        let (at, token) = self.peek();
        LawError::Unexpected { at: *at, expected, found: token.shown() }
    }

    /// Takes the mark if it is next.
    fn take(&mut self, mark: char) -> bool {
        let there = self.peek().1 == Token::Mark(mark);
        self.next += usize::from(there);
        there
    }

    fn need(&mut self, mark: char, expected: &'static str) -> Result<(), LawError> {
        if self.take(mark) { Ok(()) } else { Err(self.unexpected(expected)) }
    }

    fn push(&mut self, operation: Operation, arguments: usize) -> Result<(), LawError> {
        let at = self.peek().0;
        self.depth = self.depth + 1 - arguments;
        self.tape.push(operation);
        if self.depth > DEEPEST {
            return Err(LawError::TooLarge { at, what: "deeply nested", most: DEEPEST });
        }
        if self.tape.len() > LONGEST {
            return Err(LawError::TooLarge { at, what: "long", most: LONGEST });
        }
        Ok(())
    }

    fn sum(&mut self, level: usize) -> Result<(), LawError> {
        self.product(level)?;
        loop {
            let operation = if self.take('+') {
                Operation::Add
            } else if self.take('-') {
                Operation::Subtract
            } else {
                return Ok(());
            };
            self.product(level)?;
            self.push(operation, 2)?;
        }
    }

    fn product(&mut self, level: usize) -> Result<(), LawError> {
        self.signed(level)?;
        loop {
            let operation = if self.take('*') {
                Operation::Multiply
            } else if self.take('/') {
                Operation::Divide
            } else {
                return Ok(());
            };
            self.signed(level)?;
            self.push(operation, 2)?;
        }
    }

    fn signed(&mut self, level: usize) -> Result<(), LawError> {
        if level > DEEPEST_NESTING {
            let at = self.peek().0;
            return Err(LawError::TooLarge { at, what: "deeply nested", most: DEEPEST_NESTING });
        }
        if self.take('-') {
            self.signed(level + 1)?;
            return self.push(Operation::Negate, 1);
        }
        self.atom(level + 1)?;
        if !self.take('^') {
            return Ok(());
        }
        match *self.peek() {
            (_, Token::Number(n))
                if n.fract() == 0.0 && n <= GREATEST_EXPONENT && !self.power_follows() =>
            {
                self.next += 1;
                self.push(Operation::WholePower(n as u32), 1)
            }
            _ => {
                self.signed(level + 1)?;
                self.push(Operation::Power, 2)
            }
        }
    }

    /// Whether the token after the next one is `^` (powers group from the right).
    fn power_follows(&self) -> bool {
        self.tokens.get(self.next + 1).is_some_and(|(_, token)| *token == Token::Mark('^'))
    }

    fn atom(&mut self, level: usize) -> Result<(), LawError> {
        let (at, token) = self.peek().clone();
        match token {
            Token::Number(value) => {
                self.next += 1;
                self.push(Operation::Constant(value), 0)
            }
            Token::Mark('(') => {
                self.next += 1;
                self.sum(level)?;
                self.need(')', "`)`")
            }
            Token::Name(name) => {
                self.next += 1;
                self.name(at, name, level)
            }
            _ => Err(self.unexpected("a number, a name or `(`")),
        }
    }

    fn name(&mut self, at: usize, name: String, level: usize) -> Result<(), LawError> {
        // The user's own names come first: a parameter may be called `v`.
        if let Some(k) = self.parameters.iter().position(|p| *p == name) {
            return self.push(Operation::Parameter(k), 0);
        }
        if let Some((_, variable)) = self.variables.iter().find(|(n, _)| *n == name) {
            return self.push(Operation::Variable(*variable), 0);
        }
        if name == "pi" {
            return self.push(Operation::Constant(std::f64::consts::PI), 0);
        }
        if let Some((_, function)) = Function::ALL.iter().find(|(n, _)| *n == name) {
            self.need('(', "`(` after the function's name")?;
            self.sum(level)?;
            self.need(')', "`)`")?;
            return self.push(Operation::Apply(*function), 1);
        }
        if let Some((_, operation)) = TWO_ARGUMENTS.iter().find(|(n, _)| *n == name) {
            self.need('(', "`(` after the function's name")?;
            self.sum(level)?;
            self.need(',', "`,` and a second argument")?;
            self.sum(level)?;
            self.need(')', "`)`")?;
            return self.push(*operation, 2);
        }
        let functions = Function::ALL.iter().map(|(n, _)| *n).chain(TWO_ARGUMENTS.map(|(n, _)| n));
        Err(LawError::Name {
            at,
            name,
            variables: self.variables.iter().map(|(n, _)| *n).collect::<Vec<_>>().join(", "),
            parameters: self.parameters.join(", "),
            functions: functions.collect::<Vec<_>>().join(", "),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::law::Views;
    use crate::model::{Motor, Motors};
    use drivescope_numerics::{Dual, Real};

    fn value<R: Real>(text: &str, c: R, omega: R) -> R {
        let tape = parse(text, &["c".to_owned()], &DRIVE).expect("the law is right");
        let zero = R::zero();
        let motor =
            Motor { r: zero, l: zero, k_e: zero, k_m: zero, j: zero, b_m: zero, friction: zero };
        let at = Views {
            motors: &Motors::<R, 1>::splat(motor),
            i: &[R::constant(2.0)],
            omega: &[omega],
            theta: &[zero],
            direction: &[1.0],
            u: &[zero],
            load: &[zero],
            time: 0.0,
        };
        tape.run(&[[c]], &at)[0]
    }

    #[test]
    fn the_rules_of_arithmetic_hold() {
        let c = 3.0;
        for (text, expected) in [
            ("-c * omega * abs(omega)", 12.0),
            ("1 + 2 * c ^ 2 - -1", 20.0),
            ("-omega^2", -4.0),
            ("(1 + 2) * 3 / 2 - 1", 3.5),
            ("2 ^ 3 ^ 1", 8.0),
            ("min(c, i) + max(1.5e0, 1e-3)", 3.5),
            ("sign(omega) * sqrt(4)", -2.0),
            ("tanh(0) + sin(pi / 2) + exp(ln(1))", 2.0),
        ] {
            let found = value(text, c, -2.0);
            assert!((found - expected).abs() < 1e-14, "{text}: {found} against {expected}");
        }
        assert!((value("2 ^ 0.5", c, 0.0) - 2f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn derivatives_are_exact() {
        let text = "c * omega * abs(omega)";
        let y = value(text, Dual::<2>::parameter(3.0, 0), Dual::parameter(-2.0, 1));
        assert_eq!((y.v, y.d), (-12.0, [-4.0, 12.0]));
    }

    #[test]
    fn errors_say_where() {
        let at = |text: &str| parse(text, &[], &DRIVE).expect_err("the law is wrong").at();
        assert_eq!(at("1 + $"), 4);
        assert_eq!(at("1 + "), 4);
        assert_eq!(at("omega * k"), 8);
        assert_eq!(at("abs omega"), 4);
        assert_eq!(at("min(1)"), 5);
        assert_eq!(at("(1"), 2);
        assert_eq!(at("1 2"), 2);
        assert_eq!(at("1.2.3"), 0);
        assert_eq!(at(""), 0);
    }

    #[test]
    fn size_and_depth_are_limited() {
        let deep = format!("{}1{}", "(".repeat(500), ")".repeat(500));
        let signs = format!("{}1", "-".repeat(100_000));
        let long = vec!["1"; 1000].join("+");
        let right = format!("{}1{}", "1+(".repeat(40), ")".repeat(40));
        for text in [deep, signs, long, right] {
            let error = parse(&text, &[], &DRIVE).expect_err("too large");
            assert!(matches!(error, LawError::TooLarge { .. }), "{error}");
        }
    }
}

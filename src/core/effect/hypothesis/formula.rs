//! Formulas: arithmetic on quantities and parameters, checked for units and compiled to a flat program.
//!
//! The parser climbs precedences (Pratt) and emits the program of a stack machine at once, so that there is no tree. Its
//! depth, its stack and its length are bounded, and there are no loops, jumps or calls.

use std::fmt;

use super::super::{CableContext, Dual, PlatformContext};
use super::fault::{Fault, nearest};
use super::quantity::{FORMULA_QUANTITIES, Source, quantity, target};
use super::unit::{Dimension, Unit};

/// Deepest nesting of a formula.
const MAX_DEPTH: usize = 48;
/// Most values on the stack.
const MAX_HEIGHT: usize = 32;
/// Most operations of a formula.
const MAX_OPERATIONS: usize = 512;

/// A parameter as formulas see it.
#[derive(Debug, Clone)]
pub(super) struct Variable {
    pub name: String,
    pub unit: Unit,
    /// Whether the parameter is the label of a pose.
    pub is_pose: bool,
}

/// The names that a formula may use.
#[derive(Debug, Clone, Copy)]
pub(super) struct Names<'n> {
    pub parameters: &'n [Variable],
    /// The quantity that the formula changes; by its name it has the value that earlier effects gave it.
    pub own: &'n str,
    pub own_dimension: Dimension,
    /// Whether the changed quantity belongs to a cable.
    pub of_cable: bool,
    /// Whether the hypothesis concerns pairs of cables.
    pub of_pair: bool,
}

/// The other cable whose value is used.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Selector {
    Next,
    Previous,
    /// The other one of a pair.
    Other,
    /// The cable with this index.
    Index(usize),
}

/// Dependence of a subexpression on the quantity that the formula changes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Dependence {
    None,
    Proportional,
    Other,
}

#[derive(Clone, Copy)]
enum Operation {
    Constant(f64),
    Own,
    /// A parameter times the size of its unit.
    Parameter(usize, f64),
    Cable(fn(&CableContext) -> f64),
    CableOf(Selector, fn(&CableContext) -> f64),
    Pose(fn(&PlatformContext) -> f64),
    /// 1 from the pose on of which a parameter is the label.
    From(usize),
    /// 1 at the pose of which a parameter is the label.
    At(usize),
    Unary(Unary),
    Binary(Binary),
    Power(f64),
}

/// A compiled formula.
#[derive(Clone)]
pub(super) struct Program {
    operations: Vec<Operation>,
    /// Whether the formula is the changed quantity times a factor.
    pub is_proportional: bool,
    /// Whether the formula uses a quantity that is zero at rest.
    pub uses_motion: bool,
    /// Parameters that select the first pose, and the only pose.
    pub from_pose: Option<usize>,
    pub at_pose: Option<usize>,
    /// Parameters that the formula uses.
    pub parameters: Vec<usize>,
    /// Largest number of a cable in the formula.
    pub highest_cable: usize,
}

impl fmt::Debug for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "program of {} operations", self.operations.len())
    }
}

/// The readings of one row, and the cable for which a formula is evaluated.
#[derive(Clone, Copy)]
pub(super) struct Circumstances<'c> {
    pub cables: &'c [CableContext],
    pub platform: &'c PlatformContext,
    /// Index of the cable; `None` for the platform.
    pub cable: Option<usize>,
    /// Cables that the effect is attached to.
    pub targets: &'c [usize],
}

/// A function of one value, and of two.
type Unary = fn(Dual) -> Dual;
type Binary = fn(Dual, Dual) -> Dual;

const UNARY: [(&str, Unary); 9] = [
    ("sin", Dual::sin),
    ("cos", Dual::cos),
    ("tan", |x| x.sin() / x.cos()),
    ("asin", Dual::asin),
    ("acos", |x| -x.asin() + std::f64::consts::FRAC_PI_2),
    ("atan", |x| x.atan2(Dual::constant(1.0))),
    ("exp", Dual::exp),
    ("ln", Dual::ln),
    ("sign", |x| Dual::constant(super::super::sign(x.value))),
];
/// Functions whose value has the unit of their argument, or its root.
const UNARY_OF_UNIT: [(&str, Unary, f64); 2] = [("abs", Dual::abs, 1.0), ("sqrt", Dual::sqrt, 0.5)];
/// Functions of two values of one unit, and whether the result is a number.
const BINARY: [(&str, Binary, bool); 3] = [
    ("min", |a, b| if b.value < a.value { b } else { a }, false),
    ("max", |a, b| if b.value > a.value { b } else { a }, false),
    ("atan2", Dual::atan2, true),
];
/// Functions of the label of a pose.
const FROM_POSE: &str = "step";
const AT_POSE: &str = "only";
/// Ending of a quantity of another cable.
const OF: &str = "_of";
/// The only named constant.
const PI: &str = "pi";

/// Names that parameters cannot have.
pub(super) fn is_reserved(name: &str) -> bool {
    name == PI
        || name.ends_with(OF)
        || quantity(name).is_some()
        || formula_functions().any(|f| f == name)
}

/// Names of the functions that formulas may use.
pub fn formula_functions() -> impl Iterator<Item = &'static str> {
    let of_numbers = UNARY.iter().map(|(name, _)| *name);
    let of_units = UNARY_OF_UNIT.iter().map(|(name, ..)| *name);
    let of_two = BINARY.iter().map(|(name, ..)| *name);
    let all = of_numbers.chain(of_units).chain(of_two);
    all.chain([FROM_POSE, AT_POSE])
}

impl Program {
    /// Parses and checks a formula.
    pub fn compile(text: &str, names: Names<'_>) -> Result<Self, Fault> {
        let mut compiler = Compiler {
            text,
            at: 0,
            names,
            depth: 0,
            height: 0,
            program: Self {
                operations: Vec::new(),
                is_proportional: false,
                uses_motion: false,
                from_pose: None,
                at_pose: None,
                parameters: Vec::new(),
                highest_cable: 0,
            },
        };
        let whole = compiler.expression(0)?;
        if let Some(found) = compiler.peek() {
            return Err(compiler.fault(format!(
                "found \"{found}\", expected an operator or the end"
            )));
        }
        let expected = names.own_dimension;
        if let Some(found) = whole.dimension.filter(|found| *found != expected) {
            let message = format!(
                "found a formula in {found}, expected {expected}, the unit of {}",
                names.own
            );
            return Err(Fault::new(whole.start, message));
        }
        compiler.program.is_proportional = whole.dependence == Dependence::Proportional;
        Ok(compiler.program)
    }

    /// Value of the changed quantity; `None` where the formula has no finite value.
    pub fn evaluate(&self, values: &[Dual], own: Dual, at: &Circumstances<'_>) -> Option<Dual> {
        let mut stack = [Dual::constant(0.0); MAX_HEIGHT];
        let mut height = 0;
        for operation in &self.operations {
            let value = match operation {
                Operation::Constant(value) => Dual::constant(*value),
                Operation::Own => own,
                Operation::Parameter(index, factor) => values[*index] * *factor,
                Operation::Cable(of) => Dual::constant(of(&at.cables[at.cable?])),
                Operation::CableOf(selector, of) => {
                    Dual::constant(of(at.cables.get(at.selected(*selector)?)?))
                }
                Operation::Pose(of) => Dual::constant(of(at.platform)),
                Operation::From(index) => at.is_from(values[*index].value),
                Operation::At(index) => at.is_at(values[*index].value),
                Operation::Unary(function) => {
                    height -= 1;
                    function(stack[height])
                }
                Operation::Binary(function) => {
                    height -= 2;
                    function(stack[height], stack[height + 1])
                }
                Operation::Power(exponent) => {
                    height -= 1;
                    stack[height].power(*exponent)
                }
            };
            stack[height] = value;
            height += 1;
        }
        let result = stack[0];
        (result.value.is_finite() && result.slope.is_finite()).then_some(result)
    }
}

impl Circumstances<'_> {
    fn selected(&self, selector: Selector) -> Option<usize> {
        let count = self.cables.len();
        match selector {
            Selector::Index(index) => Some(index),
            Selector::Next => Some((self.cable? + 1) % count),
            Selector::Previous => Some((self.cable? + count - 1) % count),
            Selector::Other => {
                let mut others = self.targets.iter().copied();
                others.find(|target| Some(*target) != self.cable)
            }
        }
    }

    fn is_from(&self, label: f64) -> Dual {
        let from = match self.cable {
            Some(index) => self.cables[index].is_from(label),
            None => self.platform.is_from(label),
        };
        Dual::constant(f64::from(u8::from(from)))
    }

    fn is_at(&self, label: f64) -> Dual {
        let at = match self.cable {
            Some(index) => self.cables[index].is_at(label),
            None => self.platform.is_at(label),
        };
        Dual::constant(f64::from(u8::from(at)))
    }
}

/// A compiled operand of the formula.
#[derive(Clone, Copy)]
struct Operand {
    /// Offset in the text.
    start: usize,
    /// Index of its first operation.
    first: usize,
    /// `None` for zero, which has every unit.
    dimension: Option<Dimension>,
    constant: Option<f64>,
    dependence: Dependence,
}

struct Compiler<'t> {
    text: &'t str,
    at: usize,
    names: Names<'t>,
    depth: usize,
    height: usize,
    program: Program,
}

impl<'t> Compiler<'t> {
    fn fault(&self, message: impl Into<String>) -> Fault {
        Fault::new(self.at, message)
    }

    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    /// The next character that is not a space.
    fn peek(&mut self) -> Option<char> {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
        self.rest().chars().next()
    }

    fn take(&mut self, expected: char) -> bool {
        let found = self.peek() == Some(expected);
        if found {
            self.at += expected.len_utf8();
        }
        found
    }

    fn need(&mut self, expected: char) -> Result<(), Fault> {
        if self.take(expected) {
            return Ok(());
        }
        let found = self.found();
        Err(self.fault(format!("found {found}, expected \"{expected}\"")))
    }

    /// The next character as a message quotes it.
    fn found(&mut self) -> String {
        match self.peek() {
            Some(found) => format!("\"{}\"", found.escape_debug()),
            None => "the end".to_owned(),
        }
    }

    /// Text as long as its characters satisfy a condition.
    fn while_is(&mut self, condition: impl Fn(char) -> bool) -> &'t str {
        let rest = self.rest();
        let end = rest.find(|c| !condition(c)).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    /// Parses operators that bind at least so strongly.
    fn expression(&mut self, least: u8) -> Result<Operand, Fault> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            let message = format!("found more than {MAX_DEPTH} levels of nesting, expected fewer");
            return Err(self.fault(message));
        }
        let mut left = self.prefix()?;
        while let Some(operator) = self.peek() {
            let (strength, right) = match operator {
                '+' | '-' => (1, 2),
                '*' | '/' => (3, 4),
                '^' => (7, 6),
                _ => break,
            };
            if strength < least {
                break;
            }
            self.at += 1;
            let right = self.expression(right)?;
            left = self.combine(operator, left, right)?;
        }
        self.depth -= 1;
        Ok(left)
    }

    fn prefix(&mut self) -> Result<Operand, Fault> {
        let next = self.peek();
        let start = self.at;
        match next {
            Some('(') => {
                self.at += 1;
                let inner = self.expression(0)?;
                self.need(')')?;
                Ok(Operand { start, ..inner })
            }
            Some('-') => {
                self.at += 1;
                let part = self.expression(5)?;
                self.apply(
                    Operation::Unary(|x| -x),
                    &[part],
                    part.dimension,
                    part.dependence,
                )
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_ascii_alphabetic() => {
                let name = self.while_is(|c| c.is_ascii_alphanumeric() || c == '_');
                if self.peek() == Some('(') {
                    self.at += 1;
                    let part = self.call(name, start)?;
                    self.need(')')?;
                    return Ok(part);
                }
                self.value_of(name, start)
            }
            _ => {
                let found = self.found();
                Err(self.fault(format!("found {found}, expected a number, a name or \"(\"")))
            }
        }
    }

    /// A number, with a unit in square brackets if it has one.
    fn number(&mut self) -> Result<Operand, Fault> {
        let start = self.at;
        let _ = self.while_is(|c| c.is_ascii_digit() || c == '.');
        let mantissa = self.at;
        if self.rest().starts_with(['e', 'E']) {
            self.at += 1;
            if self.rest().starts_with(['+', '-']) {
                self.at += 1;
            }
            if self.while_is(|c| c.is_ascii_digit()).is_empty() {
                self.at = mantissa;
            }
        }
        let text = &self.text[start..self.at];
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
        let Some(value) = value else {
            let message = format!("found \"{}\", expected a number", shortened(text));
            return Err(Fault::new(start, message));
        };
        let mut unit = Unit {
            dimension: Dimension::NUMBER,
            factor: 1.0,
        };
        if self.take('[') {
            let at = self.at;
            let text = self.while_is(|c| c != ']');
            unit = Unit::parse(text).ok_or_else(|| {
                Fault::new(
                    at,
                    format!(
                        "found \"{}\", expected a unit such as m, N/m or 1/K",
                        shortened(text)
                    ),
                )
            })?;
            self.need(']')?;
        }
        let value = value * unit.factor;
        let dimension = (value != 0.0).then_some(unit.dimension);
        let part = self.push(
            Operation::Constant(value),
            start,
            dimension,
            Dependence::None,
        )?;
        Ok(Operand {
            constant: Some(value),
            ..part
        })
    }

    fn value_of(&mut self, name: &'t str, start: usize) -> Result<Operand, Fault> {
        let dimension_of = |unit: &str| Unit::parse(unit).map(|unit| unit.dimension);
        if name == self.names.own {
            let dimension = Some(self.names.own_dimension);
            return self.push(Operation::Own, start, dimension, Dependence::Proportional);
        }
        if let Some(index) = self.names.parameters.iter().position(|p| p.name == name) {
            let parameter = &self.names.parameters[index];
            if parameter.is_pose {
                let message =
                    format!("found the label of a pose, expected step({name}) or only({name})");
                return Err(Fault::new(start, message));
            }
            let unit = parameter.unit;
            self.uses(index);
            let operation = Operation::Parameter(index, unit.factor);
            return self.push(operation, start, Some(unit.dimension), Dependence::None);
        }
        if name == PI {
            let pi = std::f64::consts::PI;
            let number = Some(Dimension::NUMBER);
            let part = self.push(Operation::Constant(pi), start, number, Dependence::None)?;
            return Ok(Operand {
                constant: Some(pi),
                ..part
            });
        }
        let Some(found) = quantity(name) else {
            return Err(Fault::new(start, self.unknown(name)));
        };
        let operation = match found.source {
            Source::Cable(of) if self.names.of_cable => Operation::Cable(of),
            Source::Cable(_) => {
                let message = format!(
                    "found \"{name}\", which every cable has, in a formula of the platform; expected a cable, as {name}_of(1)"
                );
                return Err(Fault::new(start, message));
            }
            Source::Pose(of) => Operation::Pose(of),
        };
        self.program.uses_motion |= found.is_of_motion;
        self.push(operation, start, dimension_of(found.unit), Dependence::None)
    }

    fn uses(&mut self, parameter: usize) {
        if !self.program.parameters.contains(&parameter) {
            self.program.parameters.push(parameter);
        }
    }

    /// Message about a name that has no meaning in this formula.
    fn unknown(&self, name: &str) -> String {
        if target(name).is_some() {
            return format!("found \"{name}\", which only its own formula can use");
        }
        let parameters = self.names.parameters.iter().map(|p| p.name.as_str());
        let quantities = FORMULA_QUANTITIES.iter().map(|q| q.name);
        let all = parameters.chain(quantities).chain([self.names.own]);
        format!(
            "found \"{}\", expected a parameter or a quantity{}",
            shortened(name),
            nearest(name, all)
        )
    }

    /// A function, after its opening parenthesis.
    fn call(&mut self, name: &'t str, start: usize) -> Result<Operand, Fault> {
        if [FROM_POSE, AT_POSE].contains(&name) {
            return self.at_poses(name, start);
        }
        if let Some((_, function)) = UNARY.iter().find(|(known, _)| *known == name) {
            let part = self.expression(0)?;
            let is_any = name == "sign";
            if let Some(found) = part.dimension.filter(|d| !is_any && !d.is_number()) {
                let message = format!("found {found}, expected a number or an angle in {name}(..)");
                return Err(Fault::new(part.start, message));
            }
            let operation = Operation::Unary(*function);
            let part = self.apply(
                operation,
                &[part],
                Some(Dimension::NUMBER),
                Dependence::Other,
            )?;
            return Ok(Operand { start, ..part });
        }
        if let Some((_, function, power)) = UNARY_OF_UNIT.iter().find(|(known, ..)| *known == name)
        {
            let part = self.expression(0)?;
            let dimension = part.dimension.map(|d| d.power(*power));
            let part = self.apply(
                Operation::Unary(*function),
                &[part],
                dimension,
                Dependence::Other,
            )?;
            return Ok(Operand { start, ..part });
        }
        if let Some((_, function, is_number)) = BINARY.iter().find(|(known, ..)| *known == name) {
            let first = self.expression(0)?;
            self.need(',')?;
            let second = self.expression(0)?;
            let common = alike(
                &first,
                &second,
                &format!("expected the unit of the first value of {name}(..)"),
            )?;
            let dimension = if *is_number {
                Some(Dimension::NUMBER)
            } else {
                common
            };
            let operation = Operation::Binary(*function);
            let part = self.apply(operation, &[first, second], dimension, Dependence::Other)?;
            return Ok(Operand { start, ..part });
        }
        match name.strip_suffix(OF).and_then(quantity) {
            Some(_) => self.of_another(name, start),
            None => {
                let of = FORMULA_QUANTITIES.iter().filter(|q| q.is_of_cable());
                let of = of.map(|q| format!("{}{OF}", q.name));
                let all: Vec<String> = formula_functions().map(str::to_owned).chain(of).collect();
                let near = nearest(name, all.iter().map(String::as_str));
                let message = format!("found \"{}(\", expected a function{near}", shortened(name));
                Err(Fault::new(start, message))
            }
        }
    }

    /// `step(POSE)` or `only(POSE)`.
    fn at_poses(&mut self, name: &str, start: usize) -> Result<Operand, Fault> {
        let _ = self.peek();
        let at = self.at;
        let argument = self.while_is(|c| c.is_ascii_alphanumeric() || c == '_');
        let mut parameters = self.names.parameters.iter();
        let Some(index) = parameters.position(|p| p.is_pose && p.name == argument) else {
            let message = format!(
                "found \"{}\", expected a parameter with unit = \"pose\" in {name}(..)",
                shortened(argument)
            );
            return Err(Fault::new(at, message));
        };
        self.uses(index);
        let operation = if name == FROM_POSE {
            self.program.from_pose = Some(index);
            Operation::From(index)
        } else {
            self.program.at_pose = Some(index);
            Operation::At(index)
        };
        self.push(operation, start, Some(Dimension::NUMBER), Dependence::None)
    }

    /// `QUANTITY_of(CABLE)`: values of other cables are as read, so that none depends on itself.
    fn of_another(&mut self, name: &str, start: usize) -> Result<Operand, Fault> {
        let base = name.strip_suffix(OF).unwrap_or(name);
        let found = quantity(base).filter(|q| q.is_of_cable());
        let Some((found, Source::Cable(of))) = found.map(|q| (q, q.source)) else {
            let message = format!(
                "found \"{name}(\", but \"{base}\" is the same for all cables; expected \"{base}\""
            );
            return Err(Fault::new(start, message));
        };
        let _ = self.peek();
        let at = self.at;
        let which = self.while_is(|c| c.is_ascii_alphanumeric() || c == '_');
        let number = which.parse().ok().filter(|k| (1..=64).contains(k));
        let selector = match (which, number) {
            ("next", _) if self.names.of_cable => Selector::Next,
            ("previous", _) if self.names.of_cable => Selector::Previous,
            ("other", _) if self.names.of_pair => Selector::Other,
            (_, Some(number)) => {
                self.program.highest_cable = self.program.highest_cable.max(number);
                Selector::Index(number - 1)
            }
            _ => {
                let expected = match (self.names.of_cable, self.names.of_pair) {
                    (_, true) => "next, previous, other or the number of a cable",
                    (true, false) => "next, previous or the number of a cable",
                    (false, false) => "the number of a cable",
                };
                let message = format!("found \"{}\", expected {expected}", shortened(which));
                return Err(Fault::new(at, message));
            }
        };
        self.program.uses_motion |= found.is_of_motion;
        let dimension = Unit::parse(found.unit).map(|unit| unit.dimension);
        self.push(
            Operation::CableOf(selector, of),
            start,
            dimension,
            Dependence::None,
        )
    }

    fn combine(&mut self, operator: char, left: Operand, right: Operand) -> Result<Operand, Fault> {
        use Dependence::{None as Not, Other, Proportional};
        let both = (left.dependence, right.dependence);
        let times = |exponent: f64| {
            let (a, b) = left.dimension.zip(right.dimension)?;
            Some(a.times(b, exponent))
        };
        let parts = [left, right];
        match operator {
            '+' | '-' => {
                let dimension = alike(&left, &right, "expected the unit of the term before it")?;
                let dependence = match both {
                    (a, b) if a == b => a,
                    _ => Other,
                };
                let function: Binary = match operator {
                    '+' => |a, b| a + b,
                    _ => |a, b| a - b,
                };
                self.apply(Operation::Binary(function), &parts, dimension, dependence)
            }
            '*' => {
                let dependence = match both {
                    (Not, one) | (one, Not) => one,
                    _ => Other,
                };
                self.apply(
                    Operation::Binary(|a, b| a * b),
                    &parts,
                    times(1.0),
                    dependence,
                )
            }
            '/' => {
                if right.constant == Some(0.0) {
                    return Err(Fault::new(right.start, "found a division by 0"));
                }
                let dependence = match both {
                    (Not, Not) => Not,
                    (Proportional, Not) => Proportional,
                    _ => Other,
                };
                let dimension = times(-1.0);
                self.apply(
                    Operation::Binary(|a, b| a / b),
                    &parts,
                    dimension,
                    dependence,
                )
            }
            _ => self.power(left, right),
        }
    }

    fn power(&mut self, base: Operand, exponent: Operand) -> Result<Operand, Fault> {
        let is_number = exponent.dimension.is_none_or(Dimension::is_number);
        let Some(value) = exponent.constant.filter(|_| is_number) else {
            let message = "found an exponent that is not a constant, expected a number";
            return Err(Fault::new(exponent.start, message));
        };
        self.program.operations.truncate(exponent.first);
        self.height -= 1;
        let dimension = base.dimension.map(|d| d.power(value));
        self.apply(
            Operation::Power(value),
            &[base],
            dimension,
            Dependence::Other,
        )
    }

    fn push(
        &mut self,
        operation: Operation,
        start: usize,
        dimension: Option<Dimension>,
        dependence: Dependence,
    ) -> Result<Operand, Fault> {
        let first = self.program.operations.len();
        if first == MAX_OPERATIONS {
            let message = format!("found more than {MAX_OPERATIONS} operations, expected fewer");
            return Err(Fault::new(start, message));
        }
        if self.height == MAX_HEIGHT {
            let message = format!("found more than {MAX_HEIGHT} open operations, expected fewer");
            return Err(Fault::new(start, message));
        }
        self.height += 1;
        self.program.operations.push(operation);
        Ok(Operand {
            start,
            first,
            dimension,
            constant: None,
            dependence,
        })
    }

    /// Applies an operation to the operands on top of the stack; constants are computed at once.
    fn apply(
        &mut self,
        operation: Operation,
        parts: &[Operand],
        dimension: Option<Dimension>,
        dependence: Dependence,
    ) -> Result<Operand, Fault> {
        let whole = Operand {
            dimension,
            constant: None,
            dependence: match parts.iter().all(|p| p.dependence == Dependence::None) {
                true => Dependence::None,
                false => dependence,
            },
            ..parts[0]
        };
        self.height -= parts.len();
        let constants: Option<Vec<f64>> = parts.iter().map(|part| part.constant).collect();
        let Some(constants) = constants else {
            let part = self.push(operation, whole.start, dimension, whole.dependence)?;
            return Ok(Operand {
                first: whole.first,
                ..part
            });
        };
        let at = |k: usize| Dual::constant(constants[k]);
        let value = match operation {
            Operation::Unary(function) => function(at(0)).value,
            Operation::Binary(function) => function(at(0), at(1)).value,
            Operation::Power(exponent) => constants[0].powf(exponent),
            _ => f64::NAN,
        };
        if !value.is_finite() {
            return Err(Fault::new(
                whole.start,
                "found a constant without a finite value",
            ));
        }
        self.program.operations.truncate(whole.first);
        let dimension = dimension.filter(|_| value != 0.0);
        let part = self.push(
            Operation::Constant(value),
            whole.start,
            dimension,
            whole.dependence,
        )?;
        Ok(Operand {
            constant: Some(value),
            ..part
        })
    }
}

/// The common unit of two operands; `None` for zeros.
fn alike(first: &Operand, second: &Operand, expected: &str) -> Result<Option<Dimension>, Fault> {
    match (first.dimension, second.dimension) {
        (Some(one), Some(other)) if one != other => Err(Fault::new(
            second.start,
            format!("found {other}, {expected}, {one}"),
        )),
        (one, other) => Ok(one.or(other)),
    }
}

/// A text for messages.
fn shortened(text: &str) -> String {
    let start: String = text.chars().take(30).flat_map(char::escape_debug).collect();
    if text.chars().nth(30).is_some() {
        format!("{start}..")
    } else {
        start
    }
}

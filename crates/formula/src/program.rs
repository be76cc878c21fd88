//! A formula ready to be evaluated: constants, variables and results lie in one array, the frame.
//!
//! A step takes three numbers of the frame and appends its result. The length of the frame is one of a few powers of
//! two, so that a place needs a mask and no check.

use crate::join::{Code, Step, join};
use crate::number::Number;
use crate::tree::{Operand, Tree};
use alloc::boxed::Box;
use alloc::vec::Vec;

/// The lengths of a frame. 500 characters have at most 250 values, and there are at most 200 operations.
const TINY: usize = 8;
const SMALL: usize = 16;
const MEDIUM: usize = 32;
const LARGE: usize = 64;
const LARGEST: usize = 512;

/// Steps, and the frame that they begin with.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Program {
    /// The length of the frame.
    size: usize,
    /// The variables' places among the values; in the frame they come first.
    variables: Box<[usize]>,
    /// In the frame they come second; zeros for the results follow.
    constants: Box<[f64]>,
    instructions: Box<[Instruction]>,
    /// Where the first instruction leaves its result, the others after it.
    first: u16,
    /// Where the value of the formula is if there are no instructions; else it is the last result.
    value: u16,
}

/// A step, and the places of what it works on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Instruction {
    code: Code,
    places: [u16; 3],
}

impl Program {
    pub(crate) fn new(tree: &Tree) -> Self {
        let mut steps: Vec<Option<Step>> = Vec::with_capacity(tree.operations.len());
        let uses = tree.uses();
        for operation in &tree.operations {
            let step = join(operation.op, operation.operands, &mut steps, &uses);
            steps.push(Some(step));
        }
        let places = Places::new(tree, &steps);
        let instruction = |step: &Step| Instruction { code: step.code, places: step.operands.map(|o| places.of(o)) };
        let length = places.first + steps.iter().flatten().count();
        let size = [TINY, SMALL, MEDIUM, LARGE].into_iter().find(|size| length <= *size).unwrap_or(LARGEST);
        Self {
            size,
            variables: tree.variables.iter().map(|variable| variable.index).collect(),
            instructions: steps.iter().flatten().map(instruction).collect(),
            first: place(places.first),
            value: places.of(tree.root),
            constants: places.constants.into(),
        }
    }

    /// The value of the formula, where `variable` gives those of the variables.
    #[inline(always)]
    pub(crate) fn run<N: Number>(&self, variable: impl Fn(usize) -> N) -> N {
        match self.size {
            TINY => self.run_in::<N, TINY>(variable),
            SMALL => self.run_in::<N, SMALL>(variable),
            MEDIUM => self.run_in::<N, MEDIUM>(variable),
            LARGE => self.run_in::<N, LARGE>(variable),
            _ => self.run_in::<N, LARGEST>(variable),
        }
    }

    #[inline(never)]
    fn run_in<N: Number, const SIZE: usize>(&self, variable: impl Fn(usize) -> N) -> N {
        let mut frame = [N::constant(0.0); SIZE];
        let within = |place: u16| usize::from(place) % SIZE;
        let (variables, constants) = frame.split_at_mut(self.variables.len().min(SIZE));
        for (cell, index) in variables.iter_mut().zip(&self.variables) {
            *cell = variable(*index);
        }
        for (cell, value) in constants.iter_mut().zip(&self.constants) {
            *cell = N::constant(*value);
        }
        let (mut value, mut next) = (frame[within(self.value)], self.first);
        for Instruction { code, places: [a, b, c] } in &self.instructions {
            value = code.apply(frame[within(*a)], frame[within(*b)], frame[within(*c)]);
            frame[within(next)] = value;
            next = next.wrapping_add(1);
        }
        value
    }
}

/// Where everything lies in the frame: variables, constants, results.
struct Places {
    variables: usize,
    constants: Vec<f64>,
    first: usize,
    /// For each operation, how many results lie before its own.
    results: Vec<usize>,
}

impl Places {
    fn new(tree: &Tree, steps: &[Option<Step>]) -> Self {
        let operands = steps.iter().flatten().flat_map(|step| step.operands).chain([tree.root]);
        let mut constants: Vec<f64> = Vec::new();
        for operand in operands {
            if let Operand::Constant(value) = operand
                && !constants.iter().any(|known| known.to_bits() == value.to_bits())
            {
                constants.push(value);
            }
        }
        let count = |count: &mut usize, step: &Option<Step>| {
            let before = *count;
            *count += usize::from(step.is_some());
            Some(before)
        };
        let results = steps.iter().scan(0, count).collect();
        let variables = tree.variables.len();
        Self { first: variables + constants.len(), variables, constants, results }
    }

    fn of(&self, operand: Operand) -> u16 {
        place(match operand {
            Operand::Variable(k) => k,
            Operand::Constant(value) => {
                let known = self.constants.iter().position(|known| known.to_bits() == value.to_bits());
                self.variables + known.unwrap_or(0)
            }
            Operand::Result(k) => self.first + self.results.get(k).copied().unwrap_or(0),
        })
    }
}

/// A frame is shorter than 65536.
fn place(place: usize) -> u16 {
    u16::try_from(place).unwrap_or(u16::MAX)
}

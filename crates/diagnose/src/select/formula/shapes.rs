//! The shapes of which a formula is made: forces, percents of duty and shifts of the reading as functions of height,
//! velocity, duty, and of what these were before, in the units of what the record shows.
//!
//! ```text
//! curve       a0·z + Σ ak·max(0, z − zk)      z: a signal; a polygon with knots at equal distances
//! parabola    a·z + b·z² of a height; a·|z| + b·z² of a duty and a·|z| + b·z·|z| of a velocity, whose slopes are
//!             base parameters
//! ripple      a·sin(2π·z/wave) + b·cos(2π·z/wave)
//! bump        a·exp(−((x − centre)/width)²);  pull: that times (centre − x)/width
//! memory      of a state s, ds/dt = (f − s)/tau
//! hysteresis  of a state s, ds/dt = v − |v|·s/width: Dahl, "A solid friction model", Aerospace Corp. TOR-158 (1968)
//! ```
//!
//! None depends on time: what happened at moments of one record says nothing about another. Base parameters give a
//! constant, a slope over duty and one over speed already; only curves over height have their own.

use super::shape::{KNOTS, Shape, curve, number, ripple};
use super::signals::{Seen, Signals};
use plant::{Definition, Stage};

/// Size of a force, or of a share of the duty, as a share of the range seen; and of a shift of the reading.
const SHARE: f64 = 0.1;
const SHARE_OF_HEIGHT: f64 = 0.02;
/// Beyond this share of the range of velocities the sign of the velocity is smoothed no more.
const SLOW: f64 = 0.1;

/// All shapes for a record.
pub(super) fn shapes(signals: &Signals) -> Vec<&'static Definition> {
    let of = Shapes::of(signals);
    let all = [of.height(), of.height_and_speed(), of.speed(), of.duty(), of.before(), of.swinging(), of.reading()];
    all.into_iter().flatten().filter_map(Shape::definition).collect()
}

/// What the formulas of the shapes have in common.
struct Shapes<'a> {
    signals: &'a Signals,
    /// Height, velocity and duty from −1 to 1, and constant beyond what the record shows.
    x: String,
    v: String,
    u: String,
    /// The acceleration by the fan, 1 at the duty that is farthest from hover.
    f: String,
    /// The size of a force, mm/s².
    size: f64,
}

impl<'a> Shapes<'a> {
    fn of(signals: &'a Signals) -> Self {
        let limited = |signal: &str, Seen { middle, half }: Seen| {
            format!("max(-1, min(1, ({signal} - {}) / {}))", number(middle), number(half))
        };
        Self {
            x: limited("x", signals.x),
            v: limited("v", signals.v),
            u: limited("u", signals.u),
            f: limited("fan", Seen { middle: 0.0, half: signals.force }),
            size: SHARE * signals.force,
            signals,
        }
    }

    fn force(&self, name: &'static str, words: &'static str, adds: String, sizes: &[&str]) -> Shape {
        Shape::new(name, Stage::Air, words, adds).sized(sizes, self.size, "mm/s2")
    }

    fn height(&self) -> Vec<Shape> {
        let x = self.signals.x;
        let curve = format!("a0 * (x - {}) + {}", number(x.middle), curve("x", x));
        let bump = "exp(-((x - centre) / width)^2)";
        vec![
            Shape::new("formula_height_curve", Stage::Air, "a force that changes with height", curve).sized_curve(
                0..=KNOTS,
                self.size / x.half,
                "1/s2",
            ),
            self.force(
                "formula_height_parabola",
                "a force that changes steadily with height",
                format!("a * {0} + b * {0}^2", self.x),
                &["a", "b"],
            ),
            self.force("formula_height_bump", "a force at one height", format!("a * {bump}"), &["a"]).placed(x),
            self.force(
                "formula_height_pull",
                "a force that pulls to one height, or pushes from it",
                format!("a * (centre - x) / width * {bump}"),
                &["a"],
            )
            .placed(x),
            self.force("formula_height_ripple", "a force that ripples over the height", ripple("x"), &["a", "b"])
                .waved(x, "mm"),
            Shape::new(
                "formula_height_gain",
                Stage::Air,
                "a gain that changes with height",
                format!("fan * (a * {0} + b * {0}^2)", self.x),
            )
            .sized(&["a", "b"], SHARE, "1"),
        ]
    }

    fn height_and_speed(&self) -> Vec<Shape> {
        let Signals { x, v, .. } = *self.signals;
        let friction = format!("-a * tanh(v / {}) * exp(-((x - centre) / width)^2)", number(SLOW * v.half));
        vec![
            Shape::new("formula_height_friction", Stage::Ball, "friction at one height", friction)
                .sized(&["a"], self.size, "mm/s2")
                .placed(x),
            Shape::new(
                "formula_height_drag",
                Stage::Ball,
                "a drag that changes with height",
                format!("-v * (a * {0} + b * {0}^2)", self.x),
            )
            .sized(&["a", "b"], self.size / v.half, "1/s"),
        ]
    }

    fn speed(&self) -> Vec<Shape> {
        let v = self.signals.v;
        let product = format!("{0} * (a * {1} + b * abs({1})) + c * abs({0}) * {1}", self.v, self.f);
        let force = |name, words, adds, sizes: &[&str]| self.force(name, words, adds, sizes).at(Stage::Ball);
        vec![
            Shape::new("formula_speed_curve", Stage::Ball, "a force that changes with speed", curve("v", v))
                .sized_curve(1..=KNOTS, self.size / v.half, "1/s"),
            force(
                "formula_speed_parabola",
                "a force that changes steadily with speed",
                format!("a * abs({0}) + b * {0} * abs({0})", self.v),
                &["a", "b"],
            ),
            force("formula_speed_ripple", "a force that ripples over the speed", ripple("v"), &["a", "b"])
                .waved(v, "mm/s"),
            force("formula_speed_sign", "a friction", "-a * tanh(v / width)".into(), &["a"]).free(
                "width",
                SLOW * v.half,
                [0.1 * SLOW * v.half, v.half],
                "mm/s",
            ),
            force("formula_speed_force", "a force that goes with speed times duty", product, &["a", "b", "c"]),
        ]
    }

    fn duty(&self) -> Vec<Shape> {
        let u = self.signals.u;
        let parabola = format!("a * abs({0}) + b * {0}^2", self.u);
        vec![
            Shape::new("formula_duty_curve", Stage::Actuator, "a curve of the duty", curve("u", u)).sized_curve(
                1..=KNOTS,
                SHARE,
                "1",
            ),
            Shape::new("formula_duty_parabola", Stage::Actuator, "a duty that acts unequally up and down", parabola)
                .sized(&["a", "b"], SHARE * u.half, "%"),
        ]
    }

    fn before(&self) -> Vec<Shape> {
        let Self { x, v, f, .. } = self;
        let sizes = ["a", "b", "c"];
        let late = format!("(s - {f}) * (a + b * {f} + c * abs({f}))");
        let tired = format!("a * s + b * abs(s) + c * s * {f}");
        let lagged = |name, words, adds: String, sizes: &[&str], of: &str| {
            self.force(name, words, adds, sizes).lagging(of, self.signals.t)
        };
        vec![
            lagged("formula_force_late", "a part of the force that comes late", late, &sizes, f),
            lagged("formula_force_before", "a force that goes with the duty before", tired, &sizes, f),
            lagged("formula_speed_before", "a force that goes with the speed before", "a * s".into(), &["a"], v),
            lagged("formula_height_before", "a force that goes with the height before", "a * s".into(), &["a"], x),
        ]
    }

    fn swinging(&self) -> Vec<Shape> {
        let Self { f, signals, .. } = self;
        let swing = format!("(2 * pi * frequency)^2 * ({f} - p) - 4 * pi * damping * frequency * q");
        let half = signals.x.half;
        vec![
            self.force("formula_resonance", "a part of the force that swings", format!("a * (p - {f})"), &["a"])
                .free("frequency", 1.0, [0.2, 5.0], "Hz")
                .free("damping", 0.2, [0.03, 0.9], "1")
                .state("p", "q", f)
                .state("q", &swing, "0"),
            self.force("formula_hysteresis", "a friction that yields", "-a * s / width".into(), &["a"])
                .free("width", SLOW * half, [0.05 * SLOW * half, half], "mm")
                .state("s", "v - abs(v) * s / width", "0"),
        ]
    }

    fn reading(&self) -> Vec<Shape> {
        let Self { v, u, signals: Signals { x, v: speed, .. }, .. } = self;
        let size = SHARE_OF_HEIGHT * x.half;
        let sensor =
            |name, words, adds, sizes: &[&str]| Shape::new(name, Stage::Sensor, words, adds).sized(sizes, size, "mm");
        let sign = format!("tanh(v / {})", number(SLOW * speed.half));
        vec![
            Shape::new("formula_reading_curve", Stage::Sensor, "a reading that bends with height", curve("x", *x))
                .sized_curve(1..=KNOTS, SHARE_OF_HEIGHT, "1"),
            sensor("formula_reading_ripple", "a reading that ripples over the height", ripple("x"), &["a", "b"])
                .waved(*x, "mm"),
            sensor(
                "formula_reading_speed",
                "a reading that depends on the speed",
                format!("a * {v} + b * {sign} + c * abs({v})"),
                &["a", "b", "c"],
            ),
            sensor(
                "formula_reading_duty",
                "a reading that depends on the duty",
                format!("a * {u} + b * abs({u})"),
                &["a", "b"],
            ),
        ]
    }
}

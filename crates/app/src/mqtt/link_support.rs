//! What the tests of the link share: a connected link, states, and a loop that answers.

use super::about::About;
use super::link::{Endpoint, Link};
use super::mailbox::Mailbox;
use super::owner::Nobody;
use super::test_broker::{Broker, Outside, until};
use crate::flight::command::{Command, Refusal};
use crate::flight::lateness::Histogram;
use crate::flight::outside::Commander;
use crate::flight::state::{Answer, Gains, InForce, State};
use crate::flight::vocabulary::{Cycle, Mode};
use config::mqtt::MqttConfig;
use control::controller::Kind;
use std::sync::Arc;

pub(super) const SETPOINT: &str = "airball/rig1/set/setpoint_mm";
pub(super) const MODE: &str = "airball/rig1/set/mode";
pub(super) const REPLY: &str = "airball/rig1/reply";
pub(super) const STATE: &str = "airball/rig1/state";
pub(super) const STATUS: &str = "airball/rig1/status";

pub(super) fn start(config: &MqttConfig) -> (Link, Mailbox) {
    Link::start(&Endpoint::Broker(config), &about(), None, &Arc::default(), Box::new(Nobody)).unwrap()
}

/// A broker, a second client, and a connected link whose loop has been told so: `online` is published before that.
pub(super) fn connected() -> (Broker, Outside, Link, Mailbox) {
    let broker = Broker::start();
    let outside = Outside::on(broker.port);
    let (link, mailbox) = start(&broker.config());
    assert_eq!(outside.hear(STATUS), "online");
    until("the loop is told of the connection", || mailbox.is_heard().then_some(()));
    (broker, outside, link, mailbox)
}

pub(super) fn in_force(setpoint_mm: f64) -> InForce {
    let gains = Gains { kp_per_mm: 0.01, ti_s: 3.0, td_s: 0.5 };
    InForce {
        setpoint_mm: Some(setpoint_mm),
        controller: Kind::Pid,
        gains: Some(gains),
        mode: Mode::Flying,
        experiment: None,
    }
}

pub(super) fn about() -> About {
    About { rig: "rig1".into(), ..About::default() }
}

pub(super) fn state(time_s: f64) -> State {
    let InForce { setpoint_mm, controller, gains, mode, experiment } = in_force(250.0);
    let cycle = Cycle {
        time_s,
        period_s: 0.02,
        lateness_s: 0.000_1,
        mode,
        setpoint_mm,
        control_percent: Some(0.4),
        commanded_duty_percent: 21.8,
        duty_percent: 21.8,
        position_mm: Some(248.25),
        fresh: true,
        position2_mm: None,
        fan_rpm: None,
        velocity_mm_per_s: Some(-3.0),
        control_mm_per_s2: None,
        estimated_position_mm: None,
        estimated_fan_percent: None,
        estimated_disturbance_percent: None,
        innovation_mm: None,
        innovation_test_ratio: None,
    };
    State {
        cycle,
        controller,
        gains,
        experiment,
        late_cycles: 2,
        lateness: Histogram::default(),
        dropped_log_messages: 0,
        fault: None,
        stopped_by: None,
    }
}

/// The loop's answer to a command: takes the next one and refuses it or not.
pub(super) fn obey(mailbox: &mut Mailbox, refused: Option<Refusal>) -> Command {
    let command = until("a command in the mailbox", || mailbox.try_command());
    mailbox.answer(Answer { command, refused, in_force: in_force(300.0), numbers: None });
    command
}

//! The ride: task, comfort, the law's own promise, the person's effort, the computer's.

use super::{Feed, Group, Metric};
use crate::metrics::comfort::Comfort;
use crate::metrics::cost::StepTime;
use crate::metrics::lyapunov::Lyapunov;
use crate::metrics::operator::{Effort, Reversals};
use crate::metrics::sparc::Sparc;
use crate::metrics::task::{GoalReached, GoalTime, Heading, PathEfficiency, Tracking};

/// What is said of the filter.
const FILTERED: &str = "/truth, or the estimate in /step; differentiated by a critically damped \
                        filter of second order, time constant 0.1 s";

pub(super) const ROWS: &[Metric] = &[
    Metric::new(
        "tracking_rms_m",
        Group::Task,
        Feed::Motion,
        "RMS over time of the distance from the reference point to the path of the task's target; \
         undefined without a task",
        |setting| Box::new(Tracking::new(setting)),
    )
    .unit("m")
    .primary(),
    Metric::new(
        "heading_rms_rad",
        Group::Task,
        Feed::Motion,
        "RMS over time of the angle between the heading and the path of the task's target; \
         undefined without a target that moves",
        |setting| Box::new(Heading::new(setting)),
    )
    .unit("rad"),
    Metric::new(
        "goal_reached",
        Group::Task,
        Feed::Motion,
        "1 if the robot came within 0.2 m of the task's end point, else 0; undefined without a \
         task or where the body does not fit there",
        |setting| Box::new(GoalReached::new(setting)),
    )
    .higher_is_better()
    .primary(),
    Metric::new(
        "goal_time_s",
        Group::Task,
        Feed::Motion,
        "first time within 0.2 m of the task's end point; undefined if never",
        |setting| Box::new(GoalTime::new(setting)),
    )
    .unit("s")
    .primary(),
    Metric::new(
        "path_efficiency",
        Group::Task,
        Feed::Motion,
        "progress towards the task's end point per metre driven: 1 for the straight way; undefined \
         without a task or below 0.05 m",
        |setting| Box::new(PathEfficiency::new(setting)),
    )
    .higher_is_better()
    .primary(),
    Metric::new(
        "accel_rms_mps2",
        Group::Comfort,
        Feed::Motion,
        "RMS over time of the filtered forward acceleration",
        |_| Box::new(Comfort::accel_rms()),
    )
    .unit("m/s²")
    .after(FILTERED),
    Metric::new(
        "accel_p95_mps2",
        Group::Comfort,
        Feed::Motion,
        "95th percentile over time of the filtered forward acceleration's size, to 1 %",
        |_| Box::new(Comfort::accel_p95()),
    )
    .unit("m/s²")
    .after(FILTERED),
    Metric::new(
        "jerk_rms_mps3",
        Group::Comfort,
        Feed::Motion,
        "RMS over time of the filtered forward jerk",
        |_| Box::new(Comfort::jerk_rms()),
    )
    .unit("m/s³")
    .after(FILTERED),
    Metric::new(
        "jerk_p95_mps3",
        Group::Comfort,
        Feed::Motion,
        "95th percentile over time of the filtered forward jerk's size, to 1 %",
        |_| Box::new(Comfort::jerk_p95()),
    )
    .unit("m/s³")
    .after(FILTERED),
    Metric::new(
        "angular_jerk_rms_radps3",
        Group::Comfort,
        Feed::Motion,
        "RMS over time of the second rate of the filtered turn rate",
        |_| Box::new(Comfort::angular_jerk_rms()),
    )
    .unit("rad/s³")
    .after(FILTERED),
    Metric::new(
        "angular_jerk_p95_radps3",
        Group::Comfort,
        Feed::Motion,
        "95th percentile over time of the size of the second rate of the filtered turn rate, to 1 %",
        |_| Box::new(Comfort::angular_jerk_p95()),
    )
    .unit("rad/s³")
    .after(FILTERED),
    Metric::new(
        "sparc",
        Group::Comfort,
        Feed::Motion,
        "spectral arc length of |v|, mean over windows of 10 s: nearer to 0 is smoother; undefined \
         below 5 s of motion",
        |_| Box::new(Sparc::default()),
    )
    .higher_is_better()
    .after("/truth, or the estimate in /step; Balasubramanian and others (2015)"),
    Metric::new(
        "lyapunov_increases",
        Group::Law,
        Feed::Decision,
        "steps with L+ - L > 1e-6 where Lemma 1 covers them: k = 0, input of the law unaltered, \
         same branch, frame and reference, no jump of a distance, no moving disc",
        |setting| Box::new(Lyapunov::increases(setting)),
    )
    .after("/step; Lemma 1 of the paper"),
    Metric::new(
        "lyapunov_worst",
        Group::Law,
        Feed::Decision,
        "largest L+ - L over the same steps, at least 0",
        |setting| Box::new(Lyapunov::worst(setting)),
    )
    .after("/step; Lemma 1 of the paper"),
    Metric::new(
        "operator_effort",
        Group::Operator,
        Feed::Request,
        "integral of |S du_h/dt| over time: the way of the hand, 1 from rest to full speed",
        |setting| Box::new(Effort::new(setting.limits)),
    ),
    Metric::new(
        "operator_reversals_per_min",
        Group::Operator,
        Feed::Request,
        "changes of sign of v_h or omega_h between values beyond 5 % of full speed, per minute",
        |setting| Box::new(Reversals::new(setting.limits)),
    )
    .unit("1/min")
    .after("/joystick; after the steering reversal rate of McLean and Hoffmann (1975)"),
    Metric::new(
        "step_time_p50_us",
        Group::Cost,
        Feed::Timing,
        "median time that a step took; undefined where it was not recorded",
        |_| Box::new(StepTime::quantile(0.5)),
    )
    .unit("µs"),
    Metric::new(
        "step_time_p99_us",
        Group::Cost,
        Feed::Timing,
        "99th percentile of the time that a step took, to 1 %",
        |_| Box::new(StepTime::quantile(0.99)),
    )
    .unit("µs"),
    Metric::new(
        "step_time_max_us",
        Group::Cost,
        Feed::Timing,
        "longest time that a step took",
        |_| Box::new(StepTime::most()),
    )
    .unit("µs"),
];

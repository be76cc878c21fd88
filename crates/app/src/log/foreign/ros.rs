//! Messages of ROS 2 in CDR: the standard types of numbers, decoded by the library `cdr-encoding`.

use byteorder::{BigEndian, LittleEndian};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize, Serializer};
use serde_json::Value;

/// Bytes in front of every message: kind of the representation, and options.
const HEAD: usize = 4;

/// The message of a type as its fields; `None`: the type is not known, or the bytes are no message of it.
pub(super) fn value(schema: &str, data: &[u8]) -> Option<Value> {
    let name = schema.replace("/msg/", "/");
    let decode: fn(&[u8]) -> Option<Value> = match name.as_str() {
        "std_msgs/Bool" => decoded::<Data<bool>>,
        "std_msgs/Float32" => decoded::<Data<f32>>,
        "std_msgs/Float64" => decoded::<Data<f64>>,
        "std_msgs/Int8" => decoded::<Data<i8>>,
        "std_msgs/Int16" => decoded::<Data<i16>>,
        "std_msgs/Int32" => decoded::<Data<i32>>,
        "std_msgs/Int64" => decoded::<Data<i64>>,
        "std_msgs/UInt8" => decoded::<Data<u8>>,
        "std_msgs/UInt16" => decoded::<Data<u16>>,
        "std_msgs/UInt32" => decoded::<Data<u32>>,
        "std_msgs/UInt64" => decoded::<Data<u64>>,
        "std_msgs/Float32MultiArray" => decoded::<MultiArray<f32>>,
        "std_msgs/Float64MultiArray" => decoded::<MultiArray<f64>>,
        "geometry_msgs/Point" | "geometry_msgs/Vector3" => decoded::<Vector3>,
        "geometry_msgs/PointStamped" | "geometry_msgs/Vector3Stamped" => decoded::<Stamped<Vector3>>,
        "geometry_msgs/Pose" => decoded::<Pose>,
        "geometry_msgs/PoseStamped" => decoded::<Stamped<Pose>>,
        "geometry_msgs/Twist" | "geometry_msgs/Accel" => decoded::<Twist>,
        "geometry_msgs/TwistStamped" | "geometry_msgs/AccelStamped" => decoded::<Stamped<Twist>>,
        "geometry_msgs/PoseWithCovarianceStamped" => decoded::<Stamped<PoseWithCovariance>>,
        "geometry_msgs/TwistWithCovarianceStamped" => decoded::<Stamped<TwistWithCovariance>>,
        "geometry_msgs/Wrench" => decoded::<Wrench>,
        "geometry_msgs/WrenchStamped" => decoded::<Stamped<Wrench>>,
        "nav_msgs/Odometry" => decoded::<Stamped<Odometry>>,
        "sensor_msgs/FluidPressure" => decoded::<Stamped<FluidPressure>>,
        "sensor_msgs/Imu" => decoded::<Stamped<Imu>>,
        "sensor_msgs/JointState" => decoded::<Stamped<JointState>>,
        "sensor_msgs/Range" => decoded::<Stamped<Range>>,
        "sensor_msgs/Temperature" => decoded::<Stamped<Temperature>>,
        _ => return None,
    };
    decode(data)
}

fn decoded<T: DeserializeOwned + Serialize>(data: &[u8]) -> Option<Value> {
    let (head, body) = data.split_at_checked(HEAD)?;
    let message: T = match head[1] {
        0 => cdr_encoding::from_bytes::<T, BigEndian>(body).ok()?.0,
        1 => cdr_encoding::from_bytes::<T, LittleEndian>(body).ok()?.0,
        _ => return None,
    };
    serde_json::to_value(message).ok()
}

#[derive(Deserialize, Serialize)]
struct Data<T> {
    data: T,
}

#[derive(Deserialize, Serialize)]
struct MultiArray<T> {
    /// It is in front of the numbers, and of no use here.
    #[serde(rename = "layout", skip_serializing)]
    _layout: Layout,
    data: Vec<T>,
}

#[derive(Deserialize, Serialize)]
struct Layout {
    dim: Vec<Dimension>,
    data_offset: u32,
}

#[derive(Deserialize, Serialize)]
struct Dimension {
    label: String,
    size: u32,
    stride: u32,
}

#[derive(Deserialize)]
struct Header {
    sec: i32,
    nanosec: u32,
    /// Its name is in the bytes, and of no use here.
    #[serde(rename = "frame_id")]
    _frame_id: String,
}

/// A message with a header, which becomes one of its fields.
#[derive(Deserialize)]
struct Stamped<T> {
    header: Header,
    message: T,
}

impl<T: Serialize> Serialize for Stamped<T> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Header { sec, nanosec, .. } = self.header;
        let stamp_s = f64::from(sec) + 1e-9 * f64::from(nanosec);
        Flat { header: Stamp { stamp_s }, message: &self.message }.serialize(to)
    }
}

#[derive(Serialize)]
struct Flat<'a, T> {
    header: Stamp,
    #[serde(flatten)]
    message: &'a T,
}

#[derive(Serialize)]
struct Stamp {
    stamp_s: f64,
}

#[derive(Deserialize, Serialize)]
struct Vector3 {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Deserialize, Serialize)]
struct Quaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

#[derive(Deserialize, Serialize)]
struct Pose {
    position: Vector3,
    orientation: Quaternion,
}

#[derive(Deserialize, Serialize)]
struct Twist {
    linear: Vector3,
    angular: Vector3,
}

#[derive(Deserialize, Serialize)]
struct PoseWithCovariance {
    pose: Pose,
    /// A list of fixed length; it is no signal of the rig.
    #[serde(rename = "covariance", skip_serializing)]
    _covariance: [[f64; 6]; 6],
}

#[derive(Deserialize, Serialize)]
struct TwistWithCovariance {
    twist: Twist,
    #[serde(rename = "covariance", skip_serializing)]
    _covariance: [[f64; 6]; 6],
}

#[derive(Deserialize, Serialize)]
struct Odometry {
    child_frame_id: String,
    pose: PoseWithCovariance,
    twist: TwistWithCovariance,
}

#[derive(Deserialize, Serialize)]
struct Imu {
    orientation: Quaternion,
    #[serde(rename = "orientation_covariance", skip_serializing)]
    _orientation_covariance: [[f64; 3]; 3],
    angular_velocity: Vector3,
    #[serde(rename = "angular_velocity_covariance", skip_serializing)]
    _angular_velocity_covariance: [[f64; 3]; 3],
    linear_acceleration: Vector3,
    #[serde(rename = "linear_acceleration_covariance", skip_serializing)]
    _linear_acceleration_covariance: [[f64; 3]; 3],
}

#[derive(Deserialize, Serialize)]
struct FluidPressure {
    fluid_pressure: f64,
    variance: f64,
}

#[derive(Deserialize, Serialize)]
struct Wrench {
    force: Vector3,
    torque: Vector3,
}

#[derive(Deserialize, Serialize)]
struct JointState {
    name: Vec<String>,
    position: Vec<f64>,
    velocity: Vec<f64>,
    effort: Vec<f64>,
}

#[derive(Deserialize, Serialize)]
struct Range {
    radiation_type: u8,
    field_of_view: f32,
    min_range: f32,
    max_range: f32,
    range: f32,
}

#[derive(Deserialize, Serialize)]
struct Temperature {
    temperature: f64,
    variance: f64,
}

use super::*;

#[test]
fn unknown_keys_name_the_nearest() {
    let error = Params::default().set("gama1", &toml::Value::Float(1.0)).unwrap_err();
    assert_eq!(error.to_string(), "unknown parameter `gama1`; did you mean `gamma1`?");
}

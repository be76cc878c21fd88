//! Two records of one rig, before and after; and a rig with words of its own.

use system_tests::Bench;

#[test]
fn a_gain_that_fell_is_the_change_on_terminal_in_json_and_on_the_page() {
    let bench = Bench::default();
    bench.write("worn.toml", "[plant]\ngain_mm_per_s2_per_percent = 500.0\n");
    let _ = bench.output(&["simulate", "--duration", "60", "--log", "before.mcap"]);
    let _ =
        bench.output(&["simulate", "--duration", "60", "--patch", "worn.toml", "--seed", "2", "--log", "after.mcap"]);
    let said = bench.output(&["compare", "before.mcap", "after.mcap", "--html", "page.html"]);
    assert!(said.contains("changed beyond chance") && said.contains("gain_mm_per_s2_per_percent"), "{said}");
    let page = bench.read("page.html");
    assert!(page.contains("Both models on both records") && page.contains("model of before"));
    let json: serde_json::Value =
        serde_json::from_str(&bench.output(&["compare", "before.mcap", "after.mcap", "--json"])).unwrap();
    let gain = json["numbers"].as_array().unwrap().iter().find(|one| one["key"] == "gain_mm_per_s2_per_percent");
    assert_eq!(gain.unwrap()["is_beyond_chance"], true, "{json}");
    assert_eq!(json["schema"], "airball.compare/1");

    // Two diagnoses as JSON are compared by their intervals, and have no page.
    for name in ["before", "after"] {
        bench.write(&format!("{name}.json"), bench.output(&["diagnose", &format!("{name}.mcap"), "--json"]));
    }
    let said = bench.output(&["compare", "before.json", "after.json"]);
    assert!(said.contains("gain_mm_per_s2_per_percent") && said.contains("models of two diagnoses"), "{said}");
}

#[test]
fn a_rig_with_words_of_its_own_is_told_in_them_and_its_json_has_them() {
    let bench = Bench::default();
    let words = "[rig]\nposition = \"angle\"\nposition_unit = \"deg\"\ninput = \"voltage\"\ninput_unit = \"V\"\n";
    bench.write("words.toml", words);
    bench.write("friction.toml", "[plant.effects.wall_friction]\nacceleration_mm_per_s2 = 60.0\n");
    let _ = bench.output(&["simulate", "--duration", "60", "--patch", "friction.toml", "--log", "cart.mcap"]);
    let said = bench.output(&["diagnose", "cart.mcap", "--patch", "words.toml", "--html", "cart.html"]);
    assert!(said.contains("lubricate") && said.contains("the angle sticks while the voltage changes"), "{said}");
    assert!(!said.contains(" mm") && !said.contains("ball"), "{said}");
    let page = bench.read("cart.html");
    assert!(page.contains("angle, deg") && page.contains("voltage, V"));
    assert!(!page.contains(">position, mm<") && !page.contains("Clean pipe"), "words of the ball pipe are left");
    let json: serde_json::Value =
        serde_json::from_str(&bench.output(&["diagnose", "cart.mcap", "--patch", "words.toml", "--json"])).unwrap();
    assert_eq!(json["rig"]["position_unit"], "deg");
    let printed = bench.output(&["config", "print", "--patch", "words.toml"]);
    assert!(printed.contains("position_unit = \"deg\""), "{printed}");
}

use super::super::Open;
use super::*;

const VALUES: [(&str, &str); 15] = [
    ("integrator", "lvc"),
    ("max-depth", "7"),
    ("mis", "uniform"),
    ("strategies", "all,-s0"),
    ("path-roulette", "off"),
    ("light-choice", "power"),
    ("light-point", "shared"),
    ("sampler", "independent"),
    ("seed", "18446744073709551615"),
    ("shadow-rays", "per-pair"),
    ("candidates", "9,2"),
    ("next-events", "3"),
    ("proposal", "uniform"),
    ("light-start", "power"),
    ("samples-per-subpath", "4"),
];

fn request(values: &[(&str, &str)]) -> Request {
    let mut request = Request::default();
    for (name, value) in values {
        request.set(name, value).unwrap();
    }
    request
}

#[test]
fn settings_are_read_as_they_are_written() {
    let names: Vec<_> = Request::names().collect();
    assert_eq!(names.len(), VALUES.len());
    let request = request(&VALUES);
    let texts = request.texts();
    for (name, value) in VALUES {
        assert_eq!(texts[name], value);
    }
    assert_eq!(Request::read(&texts), Some(request.clone()));
    assert_eq!(Request::of(&request.apply(&Settings::default())), request);
    let texts = BTreeMap::from([("mis".to_owned(), "best".to_owned())]);
    assert_eq!(Request::read(&texts), None);
}

#[test]
fn a_request_lies_over_another() {
    let below = request(&[("mis", "power"), ("seed", "1")]);
    let above = request(&[("mis", "uniform"), ("max-depth", "2")]);
    let expected = request(&[("mis", "uniform"), ("seed", "1"), ("max-depth", "2")]);
    assert_eq!(above.over(&below), expected);
}

/// The integrator's own choice is for every integrator but `auto`, which keeps it open.
#[test]
fn choices_are_made_or_left_open() {
    let fixed = [
        ("shadow-rays", "per-pair"),
        ("candidates", "5"),
        ("next-events", "3"),
        ("path-roulette", "off"),
    ];
    let open = fixed.map(|(name, _)| (name, "auto"));
    for (name, integrator) in IntegratorKind::NAMES {
        let own = Settings::new(integrator);
        let settings = request(&fixed).apply(&own);
        assert_eq!(settings.open, Open::default(), "{name}");
        assert_eq!(settings.lvc.candidates, CandidateCount::of(5), "{name}");
        assert_eq!(settings.lvc.next_events, CandidateCount::of(3), "{name}");
        let again = request(&open).apply(&settings);
        assert_eq!(Request::of(&again), Request::of(&own), "{name}");
    }
    let texts = Request::of(&Settings::new(IntegratorKind::Auto)).texts();
    let is_open = open.iter().all(|(name, text)| texts[*name] == *text);
    assert!(is_open, "{texts:?}");
}

#[test]
fn settings_without_influence_are_named() {
    let ignored = |kind| request(&VALUES).ignored(&Settings::new(kind));
    let of_cache = ["candidates", "light-start", "next-events", "proposal"];
    let of_path = [&of_cache[..], &["light-point", "shadow-rays", "strategies"]].concat();
    let of_light = [&of_path[..], &["light-choice", "mis"]].concat();
    let expected: [(_, &[&str]); 5] = [
        (IntegratorKind::Path, &of_path),
        (IntegratorKind::Light, &of_light),
        (IntegratorKind::Bdpt, &of_cache),
        (IntegratorKind::Lvc, &[]),
        (IntegratorKind::Auto, &[]),
    ];
    for (kind, names) in expected {
        let alone = ["samples-per-subpath"];
        let alone = alone.iter().filter(|_| kind != IntegratorKind::Lvc);
        let mut names: Vec<_> = names.iter().chain(alone).copied().collect();
        names.sort_unstable();
        assert_eq!(ignored(kind), names, "{kind}");
    }
}

#[test]
fn wrong_names_and_values_are_refused_in_words() {
    let error = |name, value| Request::default().set(name, value).unwrap_err().to_string();
    for (name, value, expected) in [
        (
            "mis",
            "balence",
            "unknown name `balence`: did you mean `balance`?",
        ),
        (
            "light-point",
            "x",
            "unknown name `x`: expected fresh, shared",
        ),
        ("max-depth", "-1", "expected a whole number"),
    ] {
        assert_eq!(error(name, value), expected);
    }
    assert!(error("strategies", "s").contains("is not a strategy"));
    assert!(error("candidates", "0").contains("from 1 to 4096"));
    assert!(error("mis", "5").contains("unknown name `5`"));
    assert!(error("sharpness", "1").contains("sharpness"));
}

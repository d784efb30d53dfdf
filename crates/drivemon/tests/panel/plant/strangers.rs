//! Who may do what, tried over a real socket.

use serde_json::Value;

use super::processes::Plant;
use crate::http::{Answer, get, request};
use crate::server::{Server, refused};

const JSON: &str = "Content-Type: application/json";

fn ask(server: &Server, path: &str, token: Option<&str>) -> Answer {
    let bearer = token.map(|token| format!("Authorization: Bearer {token}"));
    let headers: Vec<&str> = bearer.iter().map(String::as_str).collect();
    request(&server.address, "GET", path, &headers, "")
}

fn act(server: &Server, path: &str, token: Option<&str>, body: &str) -> Answer {
    let bearer = token.map(|token| format!("Authorization: Bearer {token}"));
    let headers: Vec<&str> = bearer.iter().map(String::as_str).chain([JSON]).collect();
    request(&server.address, "POST", path, &headers, body)
}

const ACKNOWLEDGE: &str = "/api/fleet/alarms/1/acknowledge";

#[test]
fn strangers_and_wrong_roles_are_refused_and_counted() {
    let plant = Plant::start(3, 0, 1);
    let [see, acknowledge, configure] =
        ["see", "acknowledge", "configure"].map(|role| plant.token(role, role));
    let server = plant.page();
    // On this computer everybody sees, and nobody without a name acts.
    assert_eq!(get(&server.address, "/api/fleet/wall").status, 200);
    assert_eq!(act(&server, ACKNOWLEDGE, None, "{}").status, 401);
    assert_eq!(act(&server, ACKNOWLEDGE, Some("0123"), "{}").status, 401);
    assert_eq!(act(&server, ACKNOWLEDGE, Some(&see), "{}").status, 403);
    assert_eq!(
        ask(&server, "/api/fleet/audit", Some(&acknowledge)).status,
        403
    );
    // Who may, hears what is wrong with the question.
    let none = act(&server, ACKNOWLEDGE, Some(&acknowledge), "{}");
    assert_eq!(
        (none.status, none.json()["message"].as_str()),
        (409, Some("there is no alarm 1"))
    );
    let shelve = |body| {
        act(
            &server,
            "/api/fleet/alarms/1/shelve",
            Some(&acknowledge),
            body,
        )
        .status
    };
    assert_eq!(shelve("{\"minutes\": 5}"), 422);
    assert_eq!(shelve("{\"why\": \"\", \"minutes\": 5}"), 409);
    let long = format!("{{\"why\": \"{}\"}}", "w".repeat(301));
    assert_eq!(
        act(&server, ACKNOWLEDGE, Some(&acknowledge), &long).status,
        422
    );
    // Another site through the browser of somebody who is signed in.
    let bearer = format!("Authorization: Bearer {acknowledge}");
    let foreign = ["Origin: http://evil.example", JSON, &bearer];
    assert_eq!(
        request(&server.address, "POST", ACKNOWLEDGE, &foreign, "{}").status,
        403
    );
    let forged = act(
        &server,
        "/api/fleet/alarms/1%2f..%2f2/acknowledge",
        Some(&acknowledge),
        "{}",
    );
    assert!((400..500).contains(&forged.status), "{}", forged.status);
    for path in [
        "/api/fleet/motors/..%2f..%2fetc",
        "/api/fleet/motors/none",
        "/api/fleet/motors/m00001/trend?points=0",
        "/api/fleet/alarms?show=everything",
    ] {
        let status = ask(&server, path, None).status;
        assert!(status == 400 || status == 404, "{path}: {status}");
    }
    counted(&ask(&server, "/api/fleet/audit", Some(&configure)).json());
    let none = refused(&["--fleet", "no-such.db"]);
    assert_eq!(none.0, Some(2), "{}", none.1);
}

fn counted(audit: &Value) {
    assert_eq!(audit["refused"]["no_token"], 2, "{audit}");
    assert_eq!(audit["refused"]["wrong_role"], 2, "{audit}");
    assert_eq!(audit["refused"]["foreign"], 1, "{audit}");
    let lines = audit["lines"].as_array().expect("a list");
    let of = |who: &str, what: &str| {
        lines
            .iter()
            .any(|line| line["who"] == who && line["what"] == what && line["done"] == false)
    };
    assert!(of("see", "POST /api/fleet/alarms/1/acknowledge"), "{audit}");
    assert!(of("acknowledge", "GET /api/fleet/audit"), "{audit}");
    assert!(of("acknowledge", "acknowledge"), "{audit}");
    let added = lines
        .iter()
        .filter(|line| line["who"] == "at the terminal")
        .count();
    assert_eq!(added, 3);
}

#[test]
fn every_route_of_the_document_answers_as_it_says() {
    let plant = Plant::start(2, 0, 1);
    let configure = plant.token("Cora", "configure");
    let server = plant.page();
    plant.until("data", || {
        get(&server.address, "/api/fleet/wall").json()["counts"]["stale"] == 0
    });
    let document = get(&server.address, "/api/fleet/openapi.json").json();
    for (path, methods) in document["paths"].as_object().expect("paths") {
        for (method, operation) in methods.as_object().expect("methods") {
            let real = path.replace("{id}", "m00001").replace("{number}", "1");
            let real = match path.as_str() {
                "/api/fleet/month" => format!("{real}?month=2026-10"),
                _ => real,
            };
            let answer = match method.as_str() {
                // It never ends.
                "get" if path.ends_with("/stream") => continue,
                "get" => ask(&server, &real, Some(&configure)),
                _ => act(&server, &real, Some(&configure), "{}"),
            };
            assert!(
                ![404, 405].contains(&answer.status),
                "{method} {path}: {}",
                answer.status
            );
            if answer.status == 200 {
                let schema =
                    &operation["responses"]["200"]["content"]["application/json"]["schema"];
                keys_are_there(&document, schema, &answer.json(), path);
            }
        }
    }
}

/// Every key that the document requires is there, and no other.
fn keys_are_there(document: &Value, schema: &Value, answer: &Value, path: &str) {
    let name = schema["$ref"]
        .as_str()
        .expect("a name")
        .trim_start_matches('#');
    let schema = document.pointer(name).expect("its schema");
    let properties = schema["properties"].as_object().expect("properties");
    let answered = answer.as_object().expect("an object");
    let keys = |map: &serde_json::Map<String, Value>| map.keys().cloned().collect::<Vec<_>>();
    let (mut said, mut there) = (keys(properties), keys(answered));
    said.sort();
    there.sort();
    assert_eq!(said, there, "{path}");
}

//! Every route of the API once: the server and its OpenAPI document are made of the same table.

use std::sync::Arc;

use axum::routing::{MethodRouter, get, post};
use axum::{Extension, Json, Router, middleware};
use fleet::people::Role;
use schemars::generate::{SchemaGenerator, SchemaSettings};
use schemars::{JsonSchema, Schema};
use serde_json::{Map, Value, json};

use super::access::{Cookie, Gate, SignIn, check, me, sign_in, sign_out};
use super::actions::{self, Shelf, Why};
use super::answers::{Alarms, Audit, Done, Events, Me, Motor, Problem, Trend, Wall};
use super::overviews::metrics;
use super::overviews::models::{self, Models};
use super::overviews::month::{self, Month, WhichMonth};
use super::plant::Plant;
use super::questions::{self, Span, WhichAlarms, WhichEvents, WhichLines};
use super::stream::stream;

/// Where the document is.
const OPENAPI: &str = "/api/fleet/openapi.json";

/// A month as a page to keep.
const MONTH: &str = "/month.html";

type SchemaOf = fn(&mut SchemaGenerator) -> Schema;

/// One route.
struct Route {
    method: &'static str,
    path: &'static str,
    /// What it is for.
    summary: &'static str,
    /// Who may; `None`: everybody.
    role: Option<Role>,
    query: Option<SchemaOf>,
    body: Option<SchemaOf>,
    /// `None`: text of `media`.
    answer: Option<SchemaOf>,
    /// What an answer without a schema is.
    media: &'static str,
    handler: MethodRouter<Arc<Plant>>,
}

fn of<T: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    generator.subschema_for::<T>()
}

/// A question.
fn ask<T: JsonSchema>(
    path: &'static str,
    summary: &'static str,
    role: Option<Role>,
    handler: MethodRouter<Arc<Plant>>,
) -> Route {
    Route {
        method: "get",
        path,
        summary,
        role,
        query: None,
        body: None,
        answer: Some(of::<T>),
        media: "text/event-stream",
        handler,
    }
}

/// An action.
fn act<B: JsonSchema, T: JsonSchema>(
    path: &'static str,
    summary: &'static str,
    role: Option<Role>,
    handler: MethodRouter<Arc<Plant>>,
) -> Route {
    Route {
        method: "post",
        body: Some(of::<B>),
        ..ask::<T>(path, summary, role, handler)
    }
}

impl Route {
    fn with<Q: JsonSchema>(self) -> Self {
        Self {
            query: Some(of::<Q>),
            ..self
        }
    }
}

/// All of them.
fn routes() -> Vec<Route> {
    use Role::{Acknowledge, Configure, See};
    let streamed = ask::<Wall>(
        "/api/fleet/stream",
        "Server-sent events: `wall` (all), `news` (what changed), `alive` (once a second)",
        Some(See),
        get(stream),
    );
    vec![
        ask::<Wall>(
            "/api/fleet/wall",
            "All motors, the worst first",
            Some(See),
            get(questions::wall),
        ),
        Route {
            answer: None,
            ..streamed
        },
        ask::<Motor>(
            "/api/fleet/motors/{id}",
            "One motor",
            Some(See),
            get(questions::motor),
        ),
        ask::<Trend>(
            "/api/fleet/motors/{id}/trend",
            "A motor's history",
            Some(See),
            get(questions::trend),
        )
        .with::<Span>(),
        ask::<Alarms>(
            "/api/fleet/alarms",
            "Alarms, those that somebody has to look at first",
            Some(See),
            get(questions::alarms),
        )
        .with::<WhichAlarms>(),
        ask::<Events>(
            "/api/fleet/events",
            "What happened, the newest first",
            Some(See),
            get(questions::events),
        )
        .with::<WhichEvents>(),
        Route {
            answer: None,
            media: "text/csv",
            ..ask::<()>(
                "/api/fleet/alarms/{number}/recording",
                "The recording around an alarm, in V, A and rad/s",
                Some(See),
                get(questions::recording),
            )
        },
        ask::<Models>(
            "/api/fleet/models",
            "By which model each motor is judged, and whether a calibration is due",
            Some(See),
            get(models::models),
        ),
        ask::<Month>(
            "/api/fleet/month",
            "A month: availability, alarms, models in force, trends",
            Some(See),
            get(month::month),
        )
        .with::<WhichMonth>(),
        act::<Why, Done>(
            "/api/fleet/alarms/{number}/acknowledge",
            "Take note of an alarm",
            Some(Acknowledge),
            post(actions::acknowledge),
        ),
        act::<Shelf, Done>(
            "/api/fleet/alarms/{number}/shelve",
            "Set an alarm aside for a time",
            Some(Acknowledge),
            post(actions::shelve),
        ),
        act::<Why, Done>(
            "/api/fleet/alarms/{number}/unshelve",
            "End a shelf",
            Some(Acknowledge),
            post(actions::unshelve),
        ),
        act::<Why, Done>(
            "/api/fleet/alarms/{number}/suppress",
            "Set an alarm aside while its motor is out of service",
            Some(Configure),
            post(actions::suppress),
        ),
        act::<Why, Done>(
            "/api/fleet/alarms/{number}/unsuppress",
            "The motor is back in service",
            Some(Configure),
            post(actions::unsuppress),
        ),
        ask::<Audit>(
            "/api/fleet/audit",
            "Who did what, when and why; what was refused",
            Some(Configure),
            get(questions::audit),
        )
        .with::<WhichLines>(),
        ask::<Me>("/api/fleet/me", "Who asks", None, get(me)),
        act::<SignIn, Me>(
            "/api/fleet/session",
            "Sign in: the browser keeps the token as a cookie",
            None,
            post(sign_in),
        ),
        act::<Value, Me>(
            "/api/fleet/session/end",
            "Sign out; send {}",
            None,
            post(sign_out),
        ),
    ]
}

/// The API behind its roles.
pub(super) fn router(plant: &Arc<Plant>, cookie: &Cookie) -> Router {
    let gate = |role| Gate {
        plant: plant.clone(),
        role,
        cookie: cookie.clone(),
    };
    let mut router = Router::new();
    for Route {
        path,
        role,
        handler,
        ..
    } in routes()
    {
        let handler = match role {
            Some(role) => handler.layer(middleware::from_fn_with_state(gate(role), check)),
            None => handler,
        };
        router = router.route(path, handler);
    }
    let may_see = middleware::from_fn_with_state(gate(Role::See), check);
    router
        .route(metrics::PATH, get(metrics::metrics).layer(may_see.clone()))
        .route(MONTH, get(month::page).layer(may_see))
        .route(OPENAPI, get(async || Json(document())))
        .layer(Extension(cookie.clone()))
        .with_state(plant.clone())
}

/// The OpenAPI document, version 3.1.
pub fn document() -> Value {
    let settings = SchemaSettings::draft2020_12().with(|settings| {
        settings.definitions_path = "/components/schemas".into();
        settings.meta_schema = None;
    });
    let mut generator = settings.into_generator();
    let mut paths = Map::new();
    for route in routes() {
        let operation = operation(&route, &mut generator);
        let path = paths.entry(route.path).or_insert_with(|| json!({}));
        path[route.method] = operation;
    }
    let schemas = generator.take_definitions(true);
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": "drivemon fleet",
            "version": env!("CARGO_PKG_VERSION"),
            "description": "Motors of a plant, their history and alarms. Times are Unix milliseconds; units stand in the names. \
                            Requests that change something send application/json.",
        },
        "paths": paths,
        "components": {
            "schemas": schemas,
            "securitySchemes": {"token": {"type": "http", "scheme": "bearer", "description": "Made by `drivemon fleet user add NAME --role ROLE`"}},
        },
    })
}

fn operation(route: &Route, generator: &mut SchemaGenerator) -> Value {
    let mut parameters: Vec<_> = in_path(route.path);
    if let Some(query) = route.query {
        parameters.extend(in_query(&query(generator), generator));
    }
    let problem = of::<Problem>(generator);
    let refused = |why: &str| json!({"description": why, "content": {"application/json": {"schema": problem}}});
    let answer = match route.answer {
        Some(answer) => json!({"application/json": {"schema": answer(generator)}}),
        None => json!({route.media: {"schema": {"type": "string"}}}),
    };
    let mut answers = json!({"200": {"description": "Done", "content": answer}});
    let mut operation = json!({"summary": route.summary, "parameters": parameters});
    if let Some(role) = route.role {
        operation["security"] = json!([{"token": []}]);
        operation["description"] = json!(format!("Role: {role}."));
        answers["401"] = refused("No token, or one that is not known");
        answers["403"] = refused("The role may not");
    }
    if let Some(body) = route.body {
        operation["requestBody"] =
            json!({"required": true, "content": {"application/json": {"schema": body(generator)}}});
        if route.path.contains("{number}") {
            answers["202"] = json!({"description": "Written down; the gateway does it as soon as it can", "content": answers["200"]["content"]});
            answers["409"] = refused("The alarm does not allow it");
        }
    }
    operation["responses"] = answers;
    operation
}

fn in_path(path: &str) -> Vec<Value> {
    let names = path
        .split('/')
        .filter_map(|part| part.strip_prefix('{')?.strip_suffix('}'));
    let parameter = |name: &str| {
        let kind = if name == "number" {
            "integer"
        } else {
            "string"
        };
        json!({"name": name, "in": "path", "required": true, "schema": {"type": kind}})
    };
    names.map(parameter).collect()
}

fn in_query(schema: &Schema, generator: &SchemaGenerator) -> Vec<Value> {
    // What stands by its name among the definitions.
    let name = schema
        .get("$ref")
        .and_then(Value::as_str)
        .and_then(|path| path.rsplit('/').next());
    let named = name.and_then(|name| generator.definitions().get(name));
    let properties = named.and_then(|schema| schema.get("properties")?.as_object());
    let parameter = |(name, schema): (&String, &Value)| json!({"name": name, "in": "query", "required": false, "schema": schema, "description": schema["description"]});
    properties.into_iter().flatten().map(parameter).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_document_names_every_route_once_with_its_role_and_no_open_end() {
        let document = document();
        let paths = document["paths"].as_object().expect("paths");
        let operations: usize = paths
            .values()
            .map(|path| path.as_object().expect("an object").len())
            .sum();
        assert_eq!(operations, routes().len());
        for route in routes() {
            let operation = &document["paths"][route.path][route.method];
            assert_eq!(operation["summary"], route.summary);
            assert_eq!(
                operation["security"].is_array(),
                route.role.is_some(),
                "{}",
                route.path
            );
            let parameters = operation["parameters"].as_array().expect("a list");
            assert!(
                route.query.is_none() || parameters.iter().any(|p| p["in"] == "query"),
                "{}",
                route.path
            );
            let changes = route.method == "post";
            assert_eq!(
                operation["requestBody"].is_object(),
                changes,
                "{}",
                route.path
            );
        }
        // Every reference leads somewhere.
        let text = document.to_string();
        for reference in text.split("\"$ref\":\"#").skip(1) {
            let path = reference.split('"').next().expect("a path");
            assert!(document.pointer(path).is_some(), "{path}");
        }
    }

    #[test]
    fn what_changes_something_needs_more_than_to_see() {
        for route in routes().iter().filter(|route| route.method == "post") {
            let own = route.path.starts_with("/api/fleet/session");
            assert!(own || route.role > Some(Role::See), "{}", route.path);
        }
    }
}

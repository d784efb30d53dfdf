//! One tab of the browser, with the waiting that a person does without thinking.

use std::time::{Duration, Instant};

use base64::Engine;
use fantoccini::wd::WebDriverCompatibleCommand;
use fantoccini::{Client, ClientBuilder, Locator};
use hyper_util::client::legacy::connect::HttpConnector;
use serde_json::{Value, json};

use super::driver::Driver;

/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(90);

/// A tab.
#[derive(Clone)]
pub struct Page {
    client: Client,
}

/// A command of Chromium's own protocol.
#[derive(Debug)]
struct DevTools {
    path: &'static str,
    body: Value,
}

impl WebDriverCompatibleCommand for DevTools {
    fn endpoint(
        &self,
        base: &url::Url,
        session: Option<&str>,
    ) -> Result<url::Url, url::ParseError> {
        base.join(&format!(
            "session/{}/{}",
            session.unwrap_or_default(),
            self.path
        ))
    }

    fn method_and_body(&self, _: &url::Url) -> (http::Method, Option<String>) {
        (http::Method::POST, Some(self.body.to_string()))
    }
}

impl Page {
    /// A browser without a window.
    pub async fn open(driver: &Driver) -> Page {
        let options = json!({
            "goog:loggingPrefs": {"browser": "ALL"},
            "goog:chromeOptions": {"args": [
                "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars", "--window-size=1400,1000",
                "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"
            ]},
        });
        let Value::Object(capabilities) = options else {
            unreachable!("written above");
        };
        let client = ClientBuilder::new(HttpConnector::new())
            .capabilities(capabilities)
            .connect(&driver.url)
            .await
            .expect("the browser starts");
        Page { client }
    }

    /// Closes the browser.
    pub async fn close(self) {
        self.client.close().await.expect("it closes");
    }

    /// Opens an address.
    pub async fn go(&self, url: &str) {
        self.client.goto(url).await.expect("it opens");
    }

    /// Runs a script; `return` gives a value.
    pub async fn run(&self, script: &str) -> Value {
        self.client
            .execute(script, Vec::new())
            .await
            .expect("a sound script")
    }

    /// Waits until a JavaScript expression is true.
    pub async fn until(&self, what: &str, expression: &str) {
        let begin = Instant::now();
        while self.run(&format!("return Boolean({expression})")).await != Value::Bool(true) {
            if begin.elapsed() > PATIENCE {
                let picture = self.picture().await;
                let path = concat!(env!("CARGO_TARGET_TMPDIR"), "/panel-failure.png");
                std::fs::write(path, picture).expect("written");
                let said = "return (document.querySelector('#state') ?? document.body).innerText.slice(0, 400)";
                let (lamps, said) = (self.lamps().await, self.run(said).await);
                panic!("{what} did not come about, see {path}; lamps {lamps}; {said}");
            }
            tokio::time::sleep(Duration::from_millis(40)).await;
        }
    }

    /// Clicks on what a selector finds.
    pub async fn click(&self, css: &str) {
        let found = self
            .client
            .find(Locator::Css(css))
            .await
            .expect("it is there");
        found.click().await.expect("it can be clicked");
    }

    /// Turns a switch of the page over. Text that grows above it between aiming and clicking makes a person miss: they look, and click again.
    pub async fn turn(&self, name: &str) {
        let checked = format!("return document.querySelector('#{name}').checked");
        let before = self.run(&checked).await;
        for _ in 0..3 {
            self.click(&format!("label[for={name}]")).await;
            if self.run(&checked).await != before {
                return;
            }
        }
        panic!("#{name} does not turn");
    }

    /// Replaces the text of an input by typing.
    pub async fn fill(&self, css: &str, text: &str) {
        let found = self
            .client
            .find(Locator::Css(css))
            .await
            .expect("it is there");
        found.clear().await.expect("an input");
        found.send_keys(text).await.expect("an input");
    }

    /// Chooses files in a file input.
    pub async fn choose(&self, css: &str, files: &[std::path::PathBuf]) {
        let found = self
            .client
            .find(Locator::Css(css))
            .await
            .expect("it is there");
        let names: Vec<String> = files
            .iter()
            .map(|file| file.display().to_string())
            .collect();
        found
            .send_keys(&names.join("\n"))
            .await
            .expect("a file input");
    }

    /// Presses keys on what has the focus.
    pub async fn press(&self, keys: &str) {
        let active = self.client.active_element().await.expect("a focus");
        active.send_keys(keys).await.expect("it takes keys");
    }

    /// The text that a person sees. The page may draw the element anew between finding and reading it.
    pub async fn text(&self, css: &str) -> String {
        for _ in 0..10 {
            let found = self.client.find(Locator::Css(css)).await;
            match found.expect("it is there").text().await {
                Ok(text) => return text,
                Err(error) if error.is_stale_element_reference() => {}
                Err(error) => panic!("{css}: {error}"),
            }
        }
        panic!("{css} is drawn anew all the time");
    }

    /// Names of the lamps that are on.
    pub async fn lamps(&self) -> Value {
        self.run("return [...document.querySelectorAll('#door li[data-state=on]')].map((lamp) => lamp.dataset.lamp).join(' ')")
            .await
    }

    /// Waits until exactly these lamps are on.
    pub async fn until_lamps(&self, lit: &str) {
        let now = "[...document.querySelectorAll('#door li[data-state=on]')].map((lamp) => lamp.dataset.lamp).join(' ')";
        self.until(&format!("lamps {lit}"), &format!("{now} === '{lit}'"))
            .await;
    }

    /// A command of Chromium's own protocol.
    pub async fn devtools(&self, command: &str, parameters: Value) -> Value {
        let body = json!({"cmd": command, "params": parameters});
        let path = "goog/cdp/execute";
        self.client
            .issue_cmd(DevTools { path, body })
            .await
            .expect("a known command")
    }

    /// What is in view, as PNG.
    pub async fn picture(&self) -> Vec<u8> {
        let shot = self
            .devtools("Page.captureScreenshot", json!({"format": "png"}))
            .await;
        let data = shot["data"].as_str().expect("a picture");
        base64::engine::general_purpose::STANDARD
            .decode(data)
            .expect("base64")
    }

    /// Size of the view in CSS pixels.
    pub async fn size(&self, width: u32, height: u32) {
        self.size_at(width, height, 1).await;
    }

    /// The same on a screen with so many pixels for each.
    pub async fn size_at(&self, width: u32, height: u32, ratio: u32) {
        let metrics =
            json!({"width": width, "height": height, "deviceScaleFactor": ratio, "mobile": false});
        self.devtools("Emulation.setDeviceMetricsOverride", metrics)
            .await;
    }

    /// The console must have said nothing but that the server was away while it was away.
    pub async fn assert_silent(&self) {
        let body = json!({"type": "browser"});
        let path = "se/log";
        let said = self
            .client
            .issue_cmd(DevTools { path, body })
            .await
            .expect("the log");
        let lines = said.as_array().cloned().unwrap_or_default().into_iter();
        let messages = lines.map(|line| line["message"].as_str().unwrap_or_default().to_owned());
        let is_stream = |message: &String| {
            message.contains("/api/stream") || message.contains("/api/fleet/stream")
        };
        let away = |message: &String| is_stream(message) && message.contains("net::ERR_");
        // What the server refuses is answered by 422, which the browser notes.
        let refused = |message: &String| message.contains("status of 422");
        let complaints: Vec<String> = messages
            .filter(|message| !away(message) && !refused(message))
            .collect();
        assert_eq!(complaints, Vec::<String>::new());
    }
}

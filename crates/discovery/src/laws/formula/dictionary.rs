//! The shapes that a curve is held against: those of the program, and the user's own.

use super::kind::Kind;
use super::shape::{Over, Shape};
use document::{Document, FileError, Section};
use std::sync::LazyLock;

/// The program's own shapes.
static OWN: LazyLock<Vec<Shape>> =
    LazyLock::new(|| parsed(include_str!("shapes.toml"), "shapes.toml").unwrap_or_default());

/// Most shapes of one file.
const MOST_SHAPES: usize = 100;

/// Shapes of formulas that a law's curve is held against.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shapes {
    more: &'static [Shape],
}

impl Shapes {
    /// The program's shapes and those of a file; `file` is the name that errors print. They live as long as the program.
    ///
    /// # Errors
    /// Whatever is wrong with the text, with line, key and remedy.
    pub fn with(text: &str, file: &str) -> Result<Self, FileError> {
        let more = Vec::leak(parsed(text, file)?);
        Ok(Self { more })
    }

    /// All of them, the program's first.
    pub(crate) fn all(self) -> impl Iterator<Item = &'static Shape> {
        OWN.iter().chain(self.more)
    }
}

/// What laws are held against, and which formula is taken over.
#[derive(Clone, Copy, Debug, Default)]
pub struct Laws {
    /// Shapes of formulas.
    pub shapes: Shapes,
    /// Number of the formula that is adopted instead of the curve, from 1.
    pub formula: Option<usize>,
}

fn parsed(text: &str, file: &str) -> Result<Vec<Shape>, FileError> {
    let document = Document::parse(text, file)?;
    let root = document.root();
    let shapes = root.sections("shapes").map(|all| {
        if all.is_empty() || all.len() > MOST_SHAPES {
            let wanted = format!(
                "has {} entries: write 1 to {MOST_SHAPES} [[shapes]]",
                all.len()
            );
            root.report("shapes", wanted);
        }
        all.into_iter().filter_map(shape).collect()
    });
    root.finish();
    document.finish(shapes)
}

fn shape(section: Section<'_>) -> Option<Shape> {
    let name = section.text("name", "the name of the shape");
    let formula = section.text("formula", "the formula of x, such as \"a*tanh(x/w)\"");
    let over = section.choice("over", &Over::WORDS);
    let keys = section.entries().iter().map(|entry| entry.key.as_str());
    let own = keys.filter(|key| !["name", "formula", "over"].contains(key));
    let kind = |key: &str| Some((key.to_owned(), section.choice(key, &Kind::WORDS)?));
    let parameters: Option<Vec<_>> = own.map(kind).collect();
    let shape = (|| {
        let shape = Shape::new(&name?, &formula?, over?, parameters?);
        shape.map_err(|why| section.report("formula", why)).ok()
    })();
    section.finish();
    shape
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_of_the_program_is_understood() {
        let own = parsed(include_str!("shapes.toml"), "shapes.toml").expect("understood");
        assert_eq!(own.len(), 28);
        assert_eq!(OWN.len(), own.len());
    }

    fn refused(text: &str) -> String {
        Shapes::with(text, "mine.toml")
            .expect_err("refused")
            .to_string()
    }

    #[test]
    fn a_file_of_a_user_adds_shapes() {
        let text = "[[shapes]]\nname = \"cubic\"\nformula = \"a*(x/X)^3\"\nover = \"open\"\n";
        let all = Shapes::with(text, "mine.toml").expect("understood");
        assert_eq!(all.all().count(), OWN.len() + 1);
    }

    #[test]
    fn errors_name_file_line_key_and_remedy() {
        let text = "[[shapes]]\nname = \"q\"\nformula = \"a*tanh(x/w)\"\nover = \"open\"\n";
        let said = refused(text);
        assert!(
            said.starts_with("mine.toml:3: shapes[1].formula: "),
            "{said}"
        );
        assert!(
            said.contains("proportional") && said.contains("w = \"width\""),
            "{said}"
        );
        let said = refused(&text.replace("open", "speed"));
        assert!(
            said.contains("mine.toml:4: shapes[1].over: ") && said.contains("\"zero\""),
            "{said}"
        );
        let said = refused(&format!("{text}w = \"wide\"\n"));
        assert!(
            said.contains("mine.toml:5: shapes[1].w: ") && said.contains("\"width\""),
            "{said}"
        );
        let said = refused(&format!("{text}w = \"width\"\nn = \"exponent\"\n"));
        assert!(
            said.contains("does not use the shape parameter `n`"),
            "{said}"
        );
        assert!(refused(&text.replace("a*", "t*")).contains("take another name"));
        assert!(refused(&text.replace("a*tanh(x/w)", "a*tanh(x")).contains("formula"));
        assert!(refused("shapes = 3\n").contains("[[shapes]]"));
    }
}

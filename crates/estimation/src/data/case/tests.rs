use super::*;
use crate::specimen;

#[test]
fn a_table_is_a_case_of_points() {
    use recording::TableColumn::{Current, Speed, Torque};
    let columns = [
        (Torque, vec![0.0, 0.5, 1.0, 1.5, 1.7]),
        (Current, vec![0.8, 0.9, 1.0, 1.2, 1.3]),
        (Speed, vec![1795.0, 1770.0, 1740.0, 1700.0, 1680.0]),
    ];
    let table = LoadTable::new("table", columns.into_iter().collect()).expect("valid");
    let case = Case::of_table(&table, &specimen::prior("").plant.rated).expect("five points");
    let Case::LoadTable(points) = &case else {
        panic!("a table");
    };
    assert_eq!(points.points.len(), 5);
    assert_eq!((case.blocks().len(), case.judged()), (5, 10.0));
}

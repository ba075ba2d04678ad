//! Widgets of the panels.

mod button;
mod fault_matrix;
mod form;
mod import_row;
mod meter;
mod modal;
mod number;
mod page;
mod panel_frame;
mod parts;
mod pose_fields;
mod probability;
mod rows;
mod tab_row;
mod table;
mod text;

pub use button::{
    checkbox, choice, entered, icon_button, icon_only, named, primary, radio, row_ground,
};
pub use fault_matrix::{fault_button, fault_window};
pub use form::{combo_box, form, name_combo_box, name_text_field, text_row};
pub use import_row::{Import, import_row, path_field};
pub use meter::meter;
pub(crate) use modal::{backdrop, modal};
pub(crate) use number::width_of;
pub use number::{Entered, Number, number, number_checked, parse as parse_number};
pub use page::{COLUMN, page};
pub use panel_frame::{one_part, panel_frame};
pub use parts::parts;
pub use pose_fields::PoseFields;
pub use probability::probability;
pub use rows::{Numbers, RowField, Rows, RowsEdit, rows};
pub use tab_row::{TabOf, fitting, tab_row};
pub use table::{Cell, TableColumn, TableResponse, table};
pub use text::{UiExt, Verdict};

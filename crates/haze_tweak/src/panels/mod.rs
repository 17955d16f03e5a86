//! Panels of the window: settings as rows made from the table of fields, menus and dialogs.

pub mod comparison_bar;
pub mod copy_question;
pub mod debug_view_strip;
pub mod export_dialog;
pub mod file_menu;
pub mod gradient_drag;
pub mod hint_popup;
pub mod key_list;
pub mod lights_panel;
pub mod look_browser;
pub mod look_panel;
pub mod narrow;
pub mod notice_bar;
pub mod performance_panel;
pub mod ramp_stops;
pub mod ramps_panel;
pub mod rows;
pub mod search_box;
pub mod settings_panel;
pub mod sprite_panel;
pub mod start_view;
pub mod sun_panel;
pub mod systems_panel;
pub mod timeline;
pub mod track_editor;

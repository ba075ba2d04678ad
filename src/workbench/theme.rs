//! Design tokens: colours, fonts, spacing. No other module defines a colour.

use std::sync::Arc;

use egui::{
    Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Stroke, TextStyle, Theme,
    Vec2,
};

use crate::model::phase::Progress;

/// Grid of the layout (points).
pub const GRID: f32 = 4.0;
/// Font family of headings and emphasised text.
const STRONG: &str = "strong";

const fn rgb(hex: u32) -> Color32 {
    let [_, r, g, b] = hex.to_be_bytes();
    Color32::from_rgb(r, g, b)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Palette {
    /// Background of the 3D view and of plots.
    pub ground: Color32,
    /// Background of panels.
    pub panel: Color32,
    /// Background of fields and buttons.
    pub raised: Color32,
    /// Background of fields and buttons under the pointer.
    pub hovered: Color32,
    /// Thin separators.
    pub line: Color32,
    pub text: Color32,
    /// Units, hints, text of less importance.
    pub muted: Color32,
    /// Accent colour: the next step and the selection.
    pub accent: Color32,
    pub on_accent: Color32,
    pub good: Color32,
    pub warning: Color32,
    pub bad: Color32,
    /// Members of the robot's frame in 3D.
    pub frame: Color32,
    /// Nominal geometry, drawn translucent.
    pub ghost: Color32,
    /// Platform in 3D.
    pub platform: Color32,
    pub laser: Color32,
    /// Axes x, y, z of a coordinate frame in 3D.
    pub axes: [Color32; 3],
    /// Eight cable colours, distinct for colour-blind eyes (after Okabe and Ito).
    pub cables: [Color32; 8],
    /// Diverging scale of residuals: negative, zero, positive.
    pub diverging: [Color32; 3],
}

const DARK: Palette = Palette {
    ground: rgb(0x0012_161b),
    panel: rgb(0x001a_1f26),
    raised: rgb(0x0026_2d36),
    hovered: rgb(0x0031_3a45),
    line: rgb(0x002f_3741),
    text: rgb(0x00e4_e8ed),
    muted: rgb(0x0098_a3b0),
    accent: rgb(0x004c_9be8),
    on_accent: rgb(0x0008_1420),
    good: rgb(0x0052_bd86),
    warning: rgb(0x00e5_a93c),
    bad: rgb(0x00f0_7264),
    frame: rgb(0x004a_5563),
    ghost: rgb(0x006d_7a89),
    platform: rgb(0x00c9_d1da),
    laser: rgb(0x00ff_5b4d),
    axes: [rgb(0x00e0_6c6c), rgb(0x006c_c07a), rgb(0x006a_9cf0)],
    cables: [
        rgb(0x00e6_9f00),
        rgb(0x0056_b4e9),
        rgb(0x0000_b388),
        rgb(0x00f0_e442),
        rgb(0x004a_7fe0),
        rgb(0x00e8_6a1f),
        rgb(0x00d6_84b4),
        rgb(0x00b0_b6bd),
    ],
    diverging: [rgb(0x0059_a5f0), rgb(0x0078_8492), rgb(0x00f0_8a4b)],
};

const LIGHT: Palette = Palette {
    ground: rgb(0x00fb_fcfd),
    panel: rgb(0x00f1_f3f6),
    raised: rgb(0x00ff_ffff),
    hovered: rgb(0x00e4_e9ef),
    line: rgb(0x00d3_d9e0),
    text: rgb(0x001c_232b),
    muted: rgb(0x0059_6573),
    accent: rgb(0x001a_6bc4),
    on_accent: rgb(0x00ff_ffff),
    good: rgb(0x001c_7d4c),
    warning: rgb(0x0096_6200),
    bad: rgb(0x00bd_3425),
    frame: rgb(0x00a3_aeba),
    ghost: rgb(0x009a_a6b3),
    platform: rgb(0x005b_6875),
    laser: rgb(0x00d6_2a1c),
    axes: [rgb(0x00c2_3b3b), rgb(0x002c_8a45), rgb(0x002f_66c8)],
    cables: [
        rgb(0x00c7_7f00),
        rgb(0x002a_94d4),
        rgb(0x0000_8c66),
        rgb(0x0096_8a00),
        rgb(0x0000_56a8),
        rgb(0x00c2_4a00),
        rgb(0x00b0_4f88),
        rgb(0x0060_6a75),
    ],
    diverging: [rgb(0x001f_6fc2), rgb(0x009a_a6b3), rgb(0x00c7_5a12)],
};

#[must_use]
pub fn palette(theme: Theme) -> &'static Palette {
    match theme {
        Theme::Dark => &DARK,
        Theme::Light => &LIGHT,
    }
}

/// Colours of the present theme.
#[must_use]
pub fn of(ui: &egui::Ui) -> &'static Palette {
    palette(ui.theme())
}

impl Palette {
    /// Colour of a cable by its index; colours repeat from the ninth on, numbers do not.
    #[must_use]
    pub fn cable(&self, index: usize) -> Color32 {
        self.cables[index % self.cables.len()]
    }

    /// Colour of the progress of a phase.
    #[must_use]
    pub fn progress(&self, progress: Progress) -> Color32 {
        match progress {
            Progress::NotStarted => self.muted,
            Progress::InProgress => self.accent,
            Progress::Done => self.good,
            Progress::Attention | Progress::OutOfDate => self.warning,
        }
    }

    /// Colour of a residual in standard deviations, saturated at three.
    #[must_use]
    pub fn residual(&self, standardised: f64) -> Color32 {
        let t = (standardised / 3.0).clamp(-1.0, 1.0) as f32;
        let [below, zero, above] = self.diverging;
        zero.lerp_to_gamma(if t < 0.0 { below } else { above }, t.abs())
    }
}

/// Font of headings and emphasised text.
#[must_use]
pub fn strong(size: f32) -> FontId {
    FontId::new(size, FontFamily::Name(STRONG.into()))
}

/// Installs fonts, spacing and colours of both themes.
pub fn install(ctx: &egui::Context) {
    ctx.set_fonts(fonts());
    // The menu has these shortcuts, which must not work behind a dialog.
    ctx.options_mut(|options| options.zoom_with_keyboard = false);
    egui_material_icons::initialize(ctx);
    for theme in [Theme::Dark, Theme::Light] {
        ctx.style_mut_of(theme, |style| apply(style, palette(theme)));
    }
}

fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::empty();
    let files = [
        ("inter", tautline_workflow::fonts::REGULAR),
        ("inter-strong", tautline_workflow::fonts::STRONG),
        ("hack", epaint_default_fonts::HACK_REGULAR),
    ];
    for (name, bytes) in files {
        fonts
            .font_data
            .insert(name.into(), Arc::new(FontData::from_static(bytes)));
    }
    let mut icons = FontData::from_static(tautline_workflow::fonts::FILE_CHOOSER_ICONS);
    // Same offset as in egui_material_icons.
    icons.tweak.y_offset_factor = 0.05;
    fonts.font_data.insert("icons".into(), Arc::new(icons));
    for (family, first) in [
        (FontFamily::Proportional, "inter"),
        (FontFamily::Monospace, "hack"),
    ] {
        let names = [first, "inter", "icons"].map(str::to_owned);
        fonts.families.insert(family, names.to_vec());
    }
    fonts.families.insert(
        FontFamily::Name(STRONG.into()),
        vec!["inter-strong".into(), "inter".into(), "icons".into()],
    );
    fonts
}

fn apply(style: &mut egui::Style, palette: &Palette) {
    style.text_styles = [
        (TextStyle::Small, FontId::proportional(11.5)),
        (TextStyle::Body, FontId::proportional(13.0)),
        (TextStyle::Monospace, FontId::monospace(13.0)),
        (TextStyle::Button, FontId::proportional(13.0)),
        (TextStyle::Heading, strong(17.0)),
    ]
    .into();
    let spacing = &mut style.spacing;
    spacing.item_spacing = Vec2::new(2.0 * GRID, 1.5 * GRID);
    spacing.button_padding = Vec2::new(2.5 * GRID, GRID);
    spacing.interact_size = Vec2::new(40.0, 6.0 * GRID);
    spacing.menu_width = 240.0;
    spacing.scroll.floating = false;
    spacing.scroll.bar_width = 8.0;
    spacing.scroll.foreground_color = false;
    // Selectable labels would consume the clicks on table rows.
    style.interaction.selectable_labels = false;
    // Panel edges are easy to grab.
    style.interaction.resize_grab_radius_side = 2.0 * GRID;
    style.visuals = visuals(palette);
}

fn visuals(palette: &Palette) -> egui::Visuals {
    let mut visuals = if std::ptr::eq(palette, &LIGHT) {
        egui::Visuals::light()
    } else {
        egui::Visuals::dark()
    };
    let radius = CornerRadius::same(4);
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.panel;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    visuals.extreme_bg_color = palette.ground;
    visuals.text_edit_bg_color = Some(palette.ground);
    visuals.faint_bg_color = palette.panel.lerp_to_gamma(palette.raised, 0.45);
    visuals.code_bg_color = palette.raised;
    visuals.weak_text_color = Some(palette.muted);
    visuals.warn_fg_color = palette.warning;
    visuals.error_fg_color = palette.bad;
    visuals.hyperlink_color = palette.accent;
    visuals.selection.bg_fill = palette.accent.gamma_multiply(0.35);
    // Also the colour of selected text: the accent on itself would be unreadable.
    visuals.selection.stroke = Stroke::new(1.0, palette.text);
    visuals.striped = false;
    let states = [
        (
            &mut visuals.widgets.noninteractive,
            palette.panel,
            palette.line,
        ),
        (&mut visuals.widgets.inactive, palette.raised, palette.line),
        (&mut visuals.widgets.hovered, palette.hovered, palette.muted),
        (&mut visuals.widgets.active, palette.hovered, palette.accent),
        (&mut visuals.widgets.open, palette.hovered, palette.line),
    ];
    for (state, fill, edge) in states {
        state.bg_fill = fill;
        state.weak_bg_fill = fill;
        state.bg_stroke = Stroke::new(1.0, edge);
        state.fg_stroke = Stroke::new(1.0, palette.text);
        state.corner_radius = radius;
        state.expansion = 0.0;
    }
    // Scroll bar handles and slider rails: visible, but subdued.
    visuals.widgets.inactive.bg_fill = palette.panel.lerp_to_gamma(palette.muted, 0.4);
    visuals
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contrast of two colours (WCAG 2.2, relative luminance).
    fn contrast(a: Color32, b: Color32) -> f32 {
        let luminance = |c: Color32| {
            let [r, g, b, _] = egui::Rgba::from(c).to_array();
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn text_can_be_read_on_every_ground() {
        for theme in [Theme::Dark, Theme::Light] {
            let p = palette(theme);
            for ground in [p.ground, p.panel, p.raised] {
                for text in [p.text, p.muted, p.accent, p.good, p.warning, p.bad] {
                    let found = contrast(text, ground);
                    assert!(
                        found >= 4.5,
                        "{theme:?}: {text:?} on {ground:?} has {found:.2}"
                    );
                }
            }
            assert!(contrast(p.on_accent, p.accent) >= 4.5);
            let selected = visuals(p).selection;
            let ground = p.panel.blend(selected.bg_fill);
            assert!(contrast(selected.stroke.color, ground) >= 4.5, "{theme:?}");
            for cable in p.cables {
                assert!(contrast(cable, p.ground) >= 3.0, "{theme:?}: {cable:?}");
            }
        }
    }
}

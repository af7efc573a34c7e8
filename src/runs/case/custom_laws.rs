//! Custom laws, from outside the crate, in a case that was read from a file.

use super::Case;
use talcum_engine::contact::{ContactLaw, ContactModel};
use talcum_engine::gas::{DragLaw, GasModel};
use toml_edit::{DocumentMut, Item, TableLike, TomlError, Value, value};

impl Case {
    /// Replaces the contact law between particles in all stages, and at the walls that have the same law.
    ///
    /// The text of the case then names the law, and so do `case.toml` and checkpoints. No case file can choose a law
    /// from outside the crate, so a restart from these by a program that does not know the law fails with an error at
    /// `contact.law`, instead of continuing with another law. A program that knows the law reads the text with an
    /// override of that key, and calls this function again.
    ///
    /// If the bodies of the run are parcels (`[coarse_graining]`), the law is that of parcels.
    ///
    /// # Errors
    /// If the text of the case is no longer valid TOML.
    pub fn with_contact_law(mut self, law: &ContactLaw) -> Result<Self, TomlError> {
        self.text = renamed(&self.text, ["contact", "law"], law.name())?;
        for stage in &mut self.stages {
            let physics = &mut stage.physics;
            let replaced: Vec<ContactLaw> =
                physics.contact.values().iter().map(|model| model.law.clone()).collect();
            physics.contact = physics.contact.map(|model| model.with_law(law));
            let at_wall = |model: &ContactModel| {
                if replaced.contains(&model.law) { model.with_law(law) } else { model.clone() }
            };
            for models in &mut physics.at_walls {
                *models = models.map(at_wall);
            }
        }
        Ok(self)
    }

    /// Replaces the drag law in all stages with gas; otherwise like [`Case::with_contact_law`].
    ///
    /// # Errors
    /// If the text of the case is no longer valid TOML.
    pub fn with_drag_law(mut self, law: &DragLaw) -> Result<Self, TomlError> {
        self.text = renamed(&self.text, ["gas", "drag"], law.name())?;
        for stage in &mut self.stages {
            match &mut stage.physics.gas {
                GasModel::None => {}
                GasModel::Column(gas) => gas.drag = law.clone(),
                GasModel::VolumeAveraged(model) => model.coupling.drag.law = law.clone(),
            }
        }
        Ok(self)
    }
}

/// The text with this name for a key of all sections of a kind, those of stages included, that have the key.
fn renamed(text: &str, [section, key]: [&str; 2], name: &str) -> Result<String, TomlError> {
    let mut document: DocumentMut = text.parse()?;
    rename_in(document.as_table_mut(), [section, key], name);
    Ok(document.to_string())
}

fn rename_in(table: &mut dyn TableLike, [section, key]: [&str; 2], name: &str) {
    for (found, item) in table.iter_mut() {
        if found.get() == section {
            let law = item.as_table_like_mut().and_then(|section| section.get_mut(key));
            if let Some(law) = law {
                *law = value(name);
            }
        } else if found.get() == "stage" {
            for_each_table(item, &mut |stage| rename_in(stage, [section, key], name));
        }
    }
}

/// Applies a function to the tables of a list, in either form that TOML has for it.
fn for_each_table(item: &mut Item, work: &mut dyn FnMut(&mut dyn TableLike)) {
    match item {
        Item::ArrayOfTables(tables) => tables.iter_mut().for_each(|table| work(table)),
        Item::Value(Value::Array(values)) => {
            values.iter_mut().filter_map(Value::as_inline_table_mut).for_each(|table| work(table));
        }
        _ => {}
    }
}

//! Copies that reuse memory.

/// Implements `Clone` for a struct field by field, so that `clone_from` reuses the vectors that are
/// there. A derived `clone_from` makes new ones, and steps must not touch the heap.
#[macro_export]
macro_rules! clone_in_place {
    ($name:ident $(<$parameter:ident>)? { $($field:ident),+ $(,)? }) => {
        impl $(<$parameter: Clone>)? Clone for $name $(<$parameter>)? {
            fn clone(&self) -> Self {
                Self { $($field: self.$field.clone()),+ }
            }

            fn clone_from(&mut self, source: &Self) {
                $(self.$field.clone_from(&source.$field);)+
            }
        }
    };
}

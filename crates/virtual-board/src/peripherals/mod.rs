//! Models of the peripherals, register by register, after the reference manual.

pub(crate) mod adc;
pub(crate) mod backup;
pub(crate) mod dma;
pub(crate) mod flash;
pub(crate) mod gpio;
pub(crate) mod iwdg;
pub(crate) mod nvic;
pub(crate) mod rcc;
pub(crate) mod registers;
pub(crate) mod timer;
pub(crate) mod usart;

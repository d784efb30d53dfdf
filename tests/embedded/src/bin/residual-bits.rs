//! Prints what the core says about the sequence, numbers as their bits: on the target under QEMU by semihosting, on a
//! host to standard output. The two must be the same text.
#![cfg_attr(target_os = "none", no_std, no_main)]

/// One line per report.
macro_rules! print_report {
    ($print:path, $report:expr) => {{
        let report: &monitor::Report = $report;
        let r = report.residuals.map_or([0; 6], |x| {
            [x.r[0], x.r[1], x.r[2], x.r[3], x.e_d, x.e_q].map(f32::to_bits)
        });
        let speed = report.window.map_or(0, |w| w.omega_sync.to_bits());
        $print!(
            "{} {:08x?} {:08x} {:?}",
            report.sample_index,
            r,
            speed,
            report.lamps
        );
    }};
}

/// One line per square root; every NaN is one.
macro_rules! print_root {
    ($print:path, $bits:expr, $root:expr) => {{
        let root: f32 = $root;
        let shown = if root.is_nan() { f32::NAN } else { root };
        $print!("root {:08x} {:08x}", $bits, shown.to_bits());
    }};
}

#[cfg(target_os = "none")]
mod target {
    use cortex_m_rt::entry;
    use cortex_m_semihosting::{debug, hprintln};

    #[entry]
    fn main() -> ! {
        core_on_target::run(|report| print_report!(hprintln, report));
        core_on_target::roots(|bits, root| print_root!(hprintln, bits, root));
        debug::exit(debug::EXIT_SUCCESS);
        loop {}
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        debug::exit(debug::EXIT_FAILURE);
        loop {}
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    core_on_target::run(|report| print_report!(println, report));
    core_on_target::roots(|bits, root| print_root!(println, bits, root));
}

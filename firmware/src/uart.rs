//! The serial link through the HC-05: interrupt-driven rings on both sides, and silence while nobody is connected.

use defmt::unwrap;
use embassy_executor::Spawner;
use embassy_rp::Peri;
use embassy_rp::bind_interrupts;
use embassy_rp::gpio::{AnyPin, Input, Pull};
use embassy_rp::peripherals::{PIN_0, PIN_1, UART0};
use embassy_rp::uart::{
    BufferedInterruptHandler, BufferedUart, BufferedUartRx, BufferedUartTx, Config,
};
use embedded_io_async::{Read, Write};
use static_cell::StaticCell;

use crate::build_setting::number;
use crate::line::{Line, RECEIVED};

/// What the HC-05 is set to by `swimmer robot hc05`.
const BAUD: u32 = match number(option_env!("SWIMMER_LINK_BAUD")) {
    Some(baud) => baud,
    None => 115_200,
};
const _: () = assert!(
    BAUD >= 9_600 && BAUD <= 460_800,
    "SWIMMER_LINK_BAUD must lie between 9600 and 460800"
);
/// The receiver's ring.
const RECEIVE_RING: usize = 1024;
/// With the line behind it: what Hello advertises, and what the host keeps in flight at most.
pub(crate) const RECEIVE_BUFFER: usize = RECEIVE_RING + RECEIVED;
/// The transmitter's ring. Short, because what is in it still leaves after the connection is gone.
const SEND_RING: usize = 32;

/// Bytes from and to the HC-05.
pub(crate) static LINE: Line = Line::new();

bind_interrupts!(struct Interrupts {
    UART0_IRQ => BufferedInterruptHandler<UART0>;
});

/// Starts both directions; returns the STATE pin, high while the HC-05 is connected. A board without an HC-05 ties it
/// to 3.3 V; left open it reads low and the robot keeps silent.
pub(crate) fn start(
    spawner: Spawner,
    uart: Peri<'static, UART0>,
    tx: Peri<'static, PIN_0>,
    rx: Peri<'static, PIN_1>,
    state: Peri<'static, AnyPin>,
) -> &'static Input<'static> {
    static SEND: StaticCell<[u8; SEND_RING]> = StaticCell::new();
    static RECEIVE: StaticCell<[u8; RECEIVE_RING]> = StaticCell::new();
    static STATE: StaticCell<Input<'static>> = StaticCell::new();

    let mut config = Config::default();
    config.baudrate = BAUD;
    let (send_ring, receive_ring) = (SEND.init([0; SEND_RING]), RECEIVE.init([0; RECEIVE_RING]));
    let (tx, rx) =
        BufferedUart::new(uart, tx, rx, Interrupts, send_ring, receive_ring, config).split();
    let state: &'static Input<'static> = STATE.init(Input::new(state, Pull::Down));
    spawner.spawn(unwrap!(receive(rx)));
    spawner.spawn(unwrap!(send(tx, state)));
    state
}

#[embassy_executor::task]
async fn receive(mut rx: BufferedUartRx) {
    let mut bytes = [0; 64];
    loop {
        match rx.read(&mut bytes).await {
            Ok(count) => LINE.received.write_all(&bytes[..count]).await,
            // The frames' checksums find what is missing.
            Err(error) => defmt::debug!("UART: {}", error),
        }
    }
}

#[embassy_executor::task]
async fn send(mut tx: BufferedUartTx, state: &'static Input<'static>) {
    let mut bytes = [0; SEND_RING];
    loop {
        let count = LINE.to_send.read(&mut bytes).await;
        // While nobody is connected the HC-05 takes bytes for AT commands: they are dropped.
        if state.is_high()
            && let Err(error) = tx.write_all(&bytes[..count]).await
        {
            defmt::debug!("UART: {}", error);
        }
    }
}

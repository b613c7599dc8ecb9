//! Serial link through the HC-05: interrupt-driven ring buffers, and no transmission while the HC-05 is disconnected.

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
use crate::link_buffers::{LinkBuffers, RECEIVED};

/// Baud rate that `swimmer robot hc05` sets on the HC-05.
const BAUD: u32 = match number(option_env!("SWIMMER_LINK_BAUD")) {
    Some(baud) => baud,
    None => 115_200,
};
const _: () = assert!(
    BAUD >= 9_600 && BAUD <= 460_800,
    "SWIMMER_LINK_BAUD must lie between 9600 and 460800"
);
/// Size of the receiver's ring, bytes.
const RECEIVE_RING: usize = 1024;
/// Total receive buffer, bytes: the value in Hello, and the most that the host keeps in flight.
pub(crate) const RECEIVE_BUFFER: usize = RECEIVE_RING + RECEIVED;
/// Size of the transmitter's ring, bytes. It is short, because its content is still sent after a disconnection.
const SEND_RING: usize = 32;

/// Buffers of the UART.
pub(crate) static BUFFERS: LinkBuffers = LinkBuffers::new();

bind_interrupts!(struct Interrupts {
    UART0_IRQ => BufferedInterruptHandler<UART0>;
});

/// Starts both directions. Returns the STATE pin, high while the HC-05 is connected. A board without an HC-05 ties it to 3.3 V;
/// an open pin reads low, and the robot does not transmit.
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
            Ok(count) => BUFFERS.received.write_all(&bytes[..count]).await,
            // The frames' checksums detect the missing bytes.
            Err(error) => defmt::debug!("UART: {}", error),
        }
    }
}

#[embassy_executor::task]
async fn send(mut tx: BufferedUartTx, state: &'static Input<'static>) {
    let mut bytes = [0; SEND_RING];
    loop {
        let count = BUFFERS.to_send.read(&mut bytes).await;
        // A disconnected HC-05 would interpret bytes as AT commands, so they are dropped.
        if state.is_high()
            && let Err(error) = tx.write_all(&bytes[..count]).await
        {
            defmt::debug!("UART: {}", error);
        }
    }
}

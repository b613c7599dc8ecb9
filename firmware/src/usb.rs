//! USB cable: frames of the serial link over a CDC-ACM port, for which every system has a driver. It runs in the thread, below
//! control, like the UART's tasks. The brain distinguishes the two transports.

use defmt::unwrap;
use embassy_executor::Spawner;
use embassy_rp::Peri;
use embassy_rp::bind_interrupts;
use embassy_rp::interrupt::{self, InterruptExt, Priority};
use embassy_rp::peripherals::USB;
use embassy_rp::usb::{Driver, InterruptHandler};
use embassy_usb::class::cdc_acm::{CdcAcmClass, Receiver, Sender, State};
use embassy_usb::{Builder, Config, Handler, UsbDevice};
use portable_atomic::{AtomicBool, Ordering};
use static_cell::StaticCell;

use crate::link_buffers::LinkBuffers;

/// Test product of pid.codes: free for private use, not for sale. A robot for others needs its own number, which pid.codes
/// assigns to open designs.
const VENDOR: u16 = 0x1209;
const PRODUCT: u16 = 0x0001;
/// Largest packet of a bulk endpoint at full speed, bytes.
const PACKET: usize = 64;
/// Largest sent packet, bytes: after a full packet a host waits for more before it delivers the data.
const SENT: usize = PACKET - 1;

/// Buffers of the USB port.
pub(crate) static BUFFERS: LinkBuffers = LinkBuffers::new();
/// A computer has configured the device, and its bus is awake.
static UP: AtomicBool = AtomicBool::new(false);

bind_interrupts!(struct Interrupts {
    USBCTRL_IRQ => InterruptHandler<USB>;
});

type Bus = Driver<'static, USB>;

/// Returns true if a computer is connected.
pub(crate) fn is_up() -> bool {
    UP.load(Ordering::Relaxed)
}

/// Starts the device and both directions of its port.
pub(crate) fn start(spawner: Spawner, usb: Peri<'static, USB>) {
    static CONFIGURATION: StaticCell<[u8; 128]> = StaticCell::new();
    static BOS: StaticCell<[u8; 32]> = StaticCell::new();
    static CONTROL: StaticCell<[u8; 64]> = StaticCell::new();
    static STATE: StaticCell<State<'static>> = StaticCell::new();
    static WATCH: StaticCell<Watch> = StaticCell::new();

    let mut config = Config::new(VENDOR, PRODUCT);
    config.manufacturer = Some("swimmer");
    config.product = Some("Purcell's swimmer");
    let mut builder = Builder::new(
        Driver::new(usb, Interrupts),
        config,
        CONFIGURATION.init([0; 128]),
        BOS.init([0; 32]),
        &mut [],
        CONTROL.init([0; 64]),
    );
    builder.handler(WATCH.init(Watch));
    let port = CdcAcmClass::new(&mut builder, STATE.init(State::new()), PACKET as u16);
    let (sender, receiver) = port.split();
    // Below control: a packet can wait for a tick, but no tick for a packet.
    interrupt::USBCTRL_IRQ.set_priority(Priority::P2);
    spawner.spawn(unwrap!(run(builder.build())));
    spawner.spawn(unwrap!(receive(receiver)));
    spawner.spawn(unwrap!(send(sender)));
}

/// Handler of bus events.
struct Watch;

impl Handler for Watch {
    fn reset(&mut self) {
        UP.store(false, Ordering::Relaxed);
    }

    fn configured(&mut self, configured: bool) {
        UP.store(configured, Ordering::Relaxed);
    }

    /// A pulled cable suspends the bus if the board has another supply.
    fn suspended(&mut self, suspended: bool) {
        UP.store(!suspended, Ordering::Relaxed);
    }
}

#[embassy_executor::task]
async fn run(mut device: UsbDevice<'static, Bus>) {
    device.run().await;
}

#[embassy_executor::task]
async fn receive(mut port: Receiver<'static, Bus>) {
    let mut packet = [0; PACKET];
    loop {
        port.wait_connection().await;
        while let Ok(count) = port.read_packet(&mut packet).await {
            // If the brain is slow, the bus waits, so nothing is lost here.
            BUFFERS.received.write_all(&packet[..count]).await;
        }
    }
}

#[embassy_executor::task]
async fn send(mut port: Sender<'static, Bus>) {
    let mut packet = [0; SENT];
    loop {
        let count = BUFFERS.to_send.read(&mut packet).await;
        if is_up()
            && let Err(error) = port.write_packet(&packet[..count]).await
        {
            defmt::debug!("USB: {}", error);
        }
    }
}

//! The USB cable: the frames of the serial link over a port of class CDC-ACM, which every system has a driver for. It runs in
//! the thread, below control, as the UART's tasks do; what came over which of the two is the brain's to judge.

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

use crate::line::Line;

/// The test product of pid.codes: free to use on one's own bench, not to be sold. A robot that is given away needs a number of
/// its own, which pid.codes gives to open designs.
const VENDOR: u16 = 0x1209;
const PRODUCT: u16 = 0x0001;
/// The largest packet of a bulk endpoint at full speed.
const PACKET: usize = 64;
/// The largest that is sent: after a full one a host waits for more before it hands anything on.
const SENT: usize = PACKET - 1;

/// Bytes from and to the computer at the cable.
pub(crate) static LINE: Line = Line::new();
/// A computer has set the device up and its bus is awake.
static UP: AtomicBool = AtomicBool::new(false);

bind_interrupts!(struct Interrupts {
    USBCTRL_IRQ => InterruptHandler<USB>;
});

type Bus = Driver<'static, USB>;

/// Whether a computer is at the other end.
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
    // Below control: a packet can wait for a tick, a tick for no packet.
    interrupt::USBCTRL_IRQ.set_priority(Priority::P2);
    spawner.spawn(unwrap!(run(builder.build())));
    spawner.spawn(unwrap!(receive(receiver)));
    spawner.spawn(unwrap!(send(sender)));
}

/// Hears of what the bus does.
struct Watch;

impl Handler for Watch {
    fn reset(&mut self) {
        UP.store(false, Ordering::Relaxed);
    }

    fn configured(&mut self, configured: bool) {
        UP.store(configured, Ordering::Relaxed);
    }

    /// A cable that was pulled shows so, where the board has power from elsewhere.
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
            // Where the brain is behind, the bus waits: nothing is lost here.
            LINE.received.write_all(&packet[..count]).await;
        }
    }
}

#[embassy_executor::task]
async fn send(mut port: Sender<'static, Bus>) {
    let mut packet = [0; SENT];
    loop {
        let count = LINE.to_send.read(&mut packet).await;
        if is_up()
            && let Err(error) = port.write_packet(&packet[..count]).await
        {
            defmt::debug!("USB: {}", error);
        }
    }
}

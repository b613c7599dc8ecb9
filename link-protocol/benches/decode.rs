//! Cost of encoding and decoding a frame.
#![allow(missing_docs)] // required by criterion's macros
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use link_protocol::{Chunk, Decoder, Header, MAX_CHUNK, MAX_ENCODED, Message, Request, encode};
use std::hint::black_box;

fn decode(c: &mut Criterion) {
    let mut data = heapless::Vec::new();
    let _ = data.extend_from_slice(&[0xA5; MAX_CHUNK]);
    let message = Message::Request(Request::Chunk(Chunk {
        upload: 7,
        offset: 1040,
        data,
    }));
    let mut bytes = [0; MAX_ENCODED];
    let len = encode(Header::new(3, 9), &message, &mut bytes).unwrap();
    let mut group = c.benchmark_group("frame of a chunk");
    group.throughput(Throughput::Bytes(len as u64));
    group.bench_function("encode", |b| {
        let mut out = [0; MAX_ENCODED];
        b.iter(|| encode(Header::new(3, 9), black_box(&message), &mut out));
    });
    group.bench_function("decode", |b| {
        let mut decoder = Decoder::new();
        b.iter(|| {
            black_box(&bytes[..len])
                .iter()
                .filter_map(|&byte| decoder.push(byte))
                .count()
        });
    });
    group.finish();
}

criterion_group!(benches, decode);
criterion_main!(benches);

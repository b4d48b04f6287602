/// Bytes of a WAV file's head.
pub const WAV_HEAD: usize = 44;

/// Two channels of 16 bits.
const CHANNELS: u32 = 2;
const BYTES: u32 = 2;

/// The head of a WAV file of so many frames of stereo, 16 bits a sample. It tells its length in 32 bits: of what is longer than
/// some six hours readers that believe it hear no more than that.
#[must_use]
pub fn wav_head(frames: u64, rate_hz: u32) -> [u8; WAV_HEAD] {
    const REST: u32 = WAV_HEAD as u32 - 8;
    let data = u32::try_from(frames * u64::from(CHANNELS * BYTES)).unwrap_or(u32::MAX - REST);
    let mut out = Vec::with_capacity(WAV_HEAD);
    out.extend(b"RIFF");
    out.extend(REST.saturating_add(data).to_le_bytes());
    out.extend(b"WAVEfmt ");
    out.extend(16_u32.to_le_bytes());
    // Plain numbers.
    out.extend(1_u16.to_le_bytes());
    out.extend((CHANNELS as u16).to_le_bytes());
    out.extend(rate_hz.to_le_bytes());
    out.extend((rate_hz * CHANNELS * BYTES).to_le_bytes());
    out.extend(((CHANNELS * BYTES) as u16).to_le_bytes());
    out.extend(((BYTES * 8) as u16).to_le_bytes());
    out.extend(b"data");
    out.extend(data.to_le_bytes());
    let mut head = [0; WAV_HEAD];
    head.copy_from_slice(&out);
    head
}

/// Samples as they follow a WAV file's head; of an odd number the last has no partner and is left out.
#[must_use]
pub fn wav_samples(stereo: &[f32]) -> Vec<u8> {
    let whole = &stereo[..stereo.len() / 2 * 2];
    whole.iter().flat_map(|x| ((x.clamp(-1.0, 1.0) * 32_767.0).round() as i16).to_le_bytes()).collect()
}

/// Interleaved stereo samples as the bytes of a WAV file.
#[must_use]
pub fn wav(stereo: &[f32], rate_hz: u32) -> Vec<u8> {
    let samples = wav_samples(stereo);
    [&wav_head(stereo.len() as u64 / 2, rate_hz)[..], &samples].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_tells_what_follows() {
        let bytes = wav(&[0.0, 1.0, -1.0, 0.5, 2.0], 48_000);
        assert_eq!(bytes.len(), WAV_HEAD + 8, "an odd sample has no partner");
        assert_eq!((&bytes[..4], &bytes[8..12], &bytes[36..40]), (&b"RIFF"[..], &b"WAVE"[..], &b"data"[..]));
        let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four"));
        assert_eq!((number(4), number(24), number(28), number(40)), (44, 48_000, 192_000, 8));
        let samples: Vec<i16> = bytes[WAV_HEAD..].chunks(2).map(|b| i16::from_le_bytes([b[0], b[1]])).collect();
        assert_eq!(samples, [0, 32_767, -32_767, 16_384]);
    }
}

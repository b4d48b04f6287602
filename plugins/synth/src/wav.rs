/// Interleaved stereo samples as the bytes of a WAV file of 16 bits a sample.
///
/// A WAV file tells its length in 32 bits: of what is longer than some six hours the rest is left out.
#[must_use]
pub fn wav(stereo: &[f32], rate_hz: u32) -> Vec<u8> {
    const CHANNELS: u32 = 2;
    const BYTES: u32 = 2;
    const HEADER: u32 = 36;
    let most = ((u32::MAX - HEADER) / (CHANNELS * BYTES) * CHANNELS) as usize;
    let samples = &stereo[..stereo.len().min(most) / 2 * 2];
    let data = samples.len() as u32 * BYTES;
    let mut out = Vec::with_capacity(44 + data as usize);
    out.extend(b"RIFF");
    out.extend((HEADER + data).to_le_bytes());
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
    for x in samples {
        out.extend(((x.clamp(-1.0, 1.0) * 32_767.0).round() as i16).to_le_bytes());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_tells_what_follows() {
        let bytes = wav(&[0.0, 1.0, -1.0, 0.5, 2.0], 48_000);
        assert_eq!(bytes.len(), 44 + 8, "an odd sample has no partner");
        assert_eq!((&bytes[..4], &bytes[8..12], &bytes[36..40]), (&b"RIFF"[..], &b"WAVE"[..], &b"data"[..]));
        let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four"));
        assert_eq!((number(4), number(24), number(28), number(40)), (44, 48_000, 192_000, 8));
        let samples: Vec<i16> = bytes[44..].chunks(2).map(|b| i16::from_le_bytes([b[0], b[1]])).collect();
        assert_eq!(samples, [0, 32_767, -32_767, 16_384]);
    }
}

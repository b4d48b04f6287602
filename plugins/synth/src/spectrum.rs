//! What tests measure of samples.

use core::f64::consts::TAU;

pub(crate) fn peak(x: &[f32]) -> f32 {
    x.iter().fold(0.0, |most: f32, x| most.max(x.abs()))
}

pub(crate) fn mean(x: &[f32]) -> f64 {
    x.iter().map(|&x| f64::from(x)).sum::<f64>() / x.len().max(1) as f64
}

pub(crate) fn rms(x: &[f32]) -> f64 {
    (x.iter().map(|&x| f64::from(x) * f64::from(x)).sum::<f64>() / x.len().max(1) as f64).sqrt()
}

/// Amplitude of one frequency under a Hann window (one bin of a Fourier transform).
pub(crate) fn amplitude_at(x: &[f32], hz: f64, rate_hz: f64) -> f64 {
    let n = x.len() as f64;
    let (mut re, mut im) = (0.0, 0.0);
    for (i, &x) in x.iter().enumerate() {
        let (i, x) = (i as f64, f64::from(x));
        let window = 1.0 - (TAU * i / n).cos();
        let angle = TAU * hz * i / rate_hz;
        re += x * window * angle.cos();
        im += x * window * angle.sin();
    }
    2.0 * re.hypot(im) / n
}

/// Share of the power that lies between two frequencies, from some 200 bins.
pub(crate) fn share_between(x: &[f32], (from_hz, to_hz): (f64, f64), rate_hz: f64) -> f64 {
    let bins: Vec<f64> = (0..200).map(|n| 40.0 * (rate_hz * 0.49 / 40.0).powf(f64::from(n) / 199.0)).collect();
    // Bins lie closer the lower they are: each stands for as much as lies about it.
    let power = |&hz: &f64| amplitude_at(x, hz, rate_hz).powi(2) * hz;
    let all: f64 = bins.iter().map(power).sum();
    bins.iter().filter(|hz| (from_hz..to_hz).contains(*hz)).map(power).sum::<f64>() / all.max(1e-30)
}

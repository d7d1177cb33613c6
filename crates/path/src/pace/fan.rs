//! The speed of the part's fan by the height of a layer and by its time.

use isoslice_base::units::{Percent, Seconds};
use isoslice_settings::Cooling;

/// Speed of the fan for the setting `asked`. It is higher on layers that take
/// little time, which have less of it to cool, and lower on the first layers
/// with a fan, so that they stick to the bed. `index` counts layers from 0.
pub(super) fn fan_speed(
    asked: Percent,
    index: usize,
    time: Seconds,
    cooling: &Cooling,
) -> Percent {
    let off = f64::from(cooling.fan_off_layers);
    let full = f64::from(cooling.full_fan_layer);
    let number = index as f64 + 1.0;
    if number <= off {
        return 0.0;
    }
    let (short, long) = (cooling.min_layer_time, cooling.long_layer_time);
    let shortness = if long > short {
        ((long - time) / (long - short)).clamp(0.0, 1.0)
    } else {
        f64::from(u8::from(time < long))
    };
    let most = cooling.short_layer_fan_speed.unwrap_or(asked).max(asked);
    let wanted = asked + shortness * (most - asked);
    if number < full {
        wanted * (number - off) / (full - off)
    } else {
        wanted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fan_starts_in_steps() {
        let mut cooling = Cooling {
            fan_off_layers: 2,
            full_fan_layer: 6,
            ..Cooling::default()
        };
        let speeds: Vec<f64> = (0..8)
            .map(|i| fan_speed(80.0, i, 100.0, &cooling))
            .collect();
        let steps = [0.0, 0.0, 20.0, 40.0, 60.0, 80.0, 80.0, 80.0];
        assert_eq!(speeds, steps);
        cooling.full_fan_layer = 0;
        assert_eq!(fan_speed(80.0, 2, 100.0, &cooling), 80.0);
        assert_eq!(fan_speed(80.0, 1, 100.0, &cooling), 0.0);
    }

    #[test]
    fn short_layers_have_more_fan() {
        let mut cooling = Cooling {
            min_layer_time: 10.0,
            long_layer_time: 30.0,
            short_layer_fan_speed: Some(70.0),
            ..Cooling::default()
        };
        let at = |asked, time| fan_speed(asked, 9, time, &cooling);
        assert_eq!(at(30.0, 40.0), 30.0);
        assert_eq!(at(30.0, 20.0), 50.0);
        assert_eq!(at(30.0, 10.0), 70.0);
        assert_eq!(at(30.0, 5.0), 70.0);
        // The speed is never less than was asked for.
        assert_eq!(at(90.0, 5.0), 90.0);
        cooling.long_layer_time = 10.0;
        assert_eq!(fan_speed(30.0, 9, 10.0, &cooling), 30.0);
        assert_eq!(fan_speed(30.0, 9, 9.9, &cooling), 70.0);
    }
}

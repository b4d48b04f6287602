/// Days and months as OpenStreetMap's `opening_hours` names them.
const DAYS: [&str; 9] = ["Mo", "Tu", "We", "Th", "Fr", "Sa", "Su", "PH", "SH"];
const MONTHS: [&str; 12] = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];

/// What is wrong with opening hours, written as in OpenStreetMap: rules apart by `;`, each of months, days and times, in this order and
/// each but one of them left out where it does not matter. `24/7` and `off` stand for themselves.
///
/// Of the whole language of `opening_hours` this is what most places need; what goes beyond it is refused, for nobody here would check it.
pub(crate) fn mistake(hours: &str) -> Option<String> {
    hours.split(';').find_map(|rule| {
        let rule = rule.trim();
        let fix = "write it as in \"Apr-Oct Tu-Su 09:00-18:00; Mo off\"";
        match check_rule(rule) {
            Ok(()) => None,
            Err("") => Some(format!("the opening hours have an empty rule: {fix}")),
            Err(part) => Some(format!("`{part}` of the opening hours `{rule}` is no month, day or time: {fix}")),
        }
    })
}

/// Whether a rule is one; else the part that is not understood.
fn check_rule(rule: &str) -> Result<(), &str> {
    if rule == "24/7" {
        return Ok(());
    }
    // Months, days, times: each kind once, in this order.
    let mut at = 0;
    for word in rule.split_whitespace() {
        let kind = kind_of(word).ok_or(word)?;
        if kind < at {
            return Err(word);
        }
        at = kind + 1;
    }
    if at == 0 { Err("") } else { Ok(()) }
}

/// 0 for months, 1 for days, 2 for times.
fn kind_of(word: &str) -> Option<usize> {
    let word = word.strip_suffix(':').unwrap_or(word);
    let all = |is: &dyn Fn(&str) -> bool| word.split(',').all(|part| part.split('-').count() <= 2 && part.split('-').all(is));
    if all(&|name| MONTHS.contains(&name)) {
        return Some(0);
    }
    if all(&|name| DAYS.contains(&name)) {
        return Some(1);
    }
    let is_span =
        |part: &str| part.split_once('-').is_some_and(|(from, to)| minute(from).is_some() && minute(to).is_some() && from != to);
    (word == "off" || word.split(',').all(is_span)).then_some(2)
}

/// A time of day in minutes: up to 48:00, for what is open past midnight.
fn minute(time: &str) -> Option<u32> {
    let (hour, minute) = time.strip_suffix('+').unwrap_or(time).split_once(':')?;
    let number =
        |text: &str| (text.len() == 2 && text.bytes().all(|b| b.is_ascii_digit())).then(|| text.parse::<u32>().ok()).flatten();
    let (hour, minute) = (number(hour)?, number(minute)?);
    (minute < 60 && hour * 60 + minute <= 48 * 60).then_some(hour * 60 + minute)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hours_are_understood_or_told_with_the_part_that_is_not() {
        for good in [
            "24/7",
            "09:00-18:00",
            "Tu-Su 10:00-18:00",
            "Mo,We-Fr 09:00-12:00,13:00-17:00; Sa 10:00-14:00; Su off",
            "Apr-Oct 09:00-21:00; Nov-Mar Sa,Su 10:00-18:00; PH off",
            "Fr 20:00-02:00",
        ] {
            assert_eq!(mistake(good), None, "{good}");
        }
        for (bad, part) in [
            ("Tue-Sun 10:00-18:00", "Tue-Sun"),
            ("10-18", "10-18"),
            ("Mo 10:00-18:60", "10:00-18:60"),
            ("Mo 9:00-18:00", "9:00-18:00"),
            ("10:00-18:00 Mo", "Mo"),
            ("Mo-Tu-We 10:00-18:00", "Mo-Tu-We"),
            ("by appointment", "by"),
            ("Mo 49:00-50:00", "49:00-50:00"),
        ] {
            assert!(mistake(bad).is_some_and(|told| told.contains(&format!("`{part}`"))), "{bad}: {:?}", mistake(bad));
        }
        assert!(mistake("Mo 10:00-12:00;").is_some_and(|told| told.contains("empty rule")));
    }
}

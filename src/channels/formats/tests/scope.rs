use super::*;

const HEAD: &str = "Name\tYT Chart\nFile\tC:\\log.csv\nStartRecord\tDienstag, 7. Mai 2024 10:00:00\nEndRecord\tDienstag, 7. Mai 2024 10:00:01\n\n";

fn body() -> String {
    "Name\tGVL.Winch1.Pos\tName\tGVL.Winch2.Pos\tName\tGVL.Temp\n\
     NetId\t1.2.3.4.1.1\tNetId\t1.2.3.4.1.1\tNetId\t1.2.3.4.1.1\n\
     SampleTime[ms]\t2\tSampleTime[ms]\t2\tSampleTime[ms]\t4\n\
     Unit\tmm\tUnit\tmm\tUnit\t\n\
     ScaleFactor\t1\tScaleFactor\t1\tScaleFactor\t1\n\
     \n\
     0\t1.5\t0\t-2\t0\t20.5\n\
     1\t1.6\t1\t-3\t1\t20.6\n\
     2\t1.7\t2\t-4\t\t\n\
     \t\t\t\t\t\n\
     EOF\n"
        .into()
}

fn check(source: &Source) {
    assert_eq!(source.format, Format::TwinCatScope);
    assert_eq!(source.series.len(), 2, "{:?}", source.notices);
    let fast = &source.series[0];
    assert_eq!(times(fast).as_deref(), Some(&[0.0, 0.002, 0.004][..]));
    assert_eq!(
        content(fast),
        [
            channel("GVL.Winch1.Pos", Some("mm"), &[1.5, 1.6, 1.7]),
            channel("GVL.Winch2.Pos", Some("mm"), &[-2.0, -3.0, -4.0])
        ]
    );
    let slow = &source.series[1];
    assert_eq!(times(slow).as_deref(), Some(&[0.0, 0.004][..]));
    assert_eq!(content(slow), [channel("GVL.Temp", None, &[20.5, 20.6])]);
}

#[test]
fn every_separator_and_locale_is_read_to_the_same_channels() {
    let tabs = format!("{HEAD}{}", body());
    let source = read("a.csv", &tabs);
    check(&source);
    assert_eq!(source.notices, [""; 0]);
    // German: decimal commas and semicolons.
    check(&read(
        "b.csv",
        tabs.replace('.', ",")
            .replace("GVL,Winch1,Pos", "GVL.Winch1.Pos")
            .replace("GVL,Winch2,Pos", "GVL.Winch2.Pos")
            .replace("GVL,Temp", "GVL.Temp")
            .replace('\t', ";"),
    ));
    // Times in milliseconds instead of numbers of samples, and lines of Windows.
    let times = body()
        .replace("\n1\t1.6\t1\t-3\t1\t", "\n2\t1.6\t2\t-3\t4\t")
        .replace("\n2\t1.7\t2\t-4", "\n4\t1.7\t4\t-4");
    check(&read(
        "c.csv",
        format!("{HEAD}{times}").replace('\n', "\r\n"),
    ));
    check(&read("d.csv", tabs.replace('\t', ",")));
}

#[test]
fn a_file_that_was_cut_off_is_read_as_far_as_it_goes() {
    let whole = format!("{HEAD}{}", body());
    let cut = &whole[..whole.find("\n\t\t\t\t\t").expect("the end")];
    let source = read("a.csv", cut);
    check(&source);
    assert_eq!(
        source.notices,
        ["a.csv: ends without EOF: the export was cut off"]
    );
    let scaled = whole.replace(
        "ScaleFactor\t1\tScaleFactor\t1\tScaleFactor\t1",
        "ScaleFactor\t1\tScaleFactor\t1\tScaleFactor\t0.1",
    );
    let source = read("b.csv", scaled);
    assert_eq!(
        source.notices,
        [
            "b.csv: a ScaleFactor other than 1 is stated for \"GVL.Temp\"; the values are used as written"
        ]
    );
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    let whole = format!("{HEAD}{}", body());
    for (text, part) in [
        (
            whole.replace("\t1.6\t", "\tabc\t"),
            "a.csv, line 13, column \"GVL.Winch1.Pos\": found \"abc\", expected a number",
        ),
        (
            whole.replace("NetId\t1.2.3.4.1.1\tNetId\t1.2.3.4.1.1\tNetId", "NetId"),
            "a.csv, line 7: found 1 values of \"NetId\", expected one for each of 3 channels",
        ),
        (
            whole.replace("\t1.6\t", "\t1,6\t"),
            "column \"GVL.Winch1.Pos\": found decimal points and decimal commas",
        ),
        (
            format!("{HEAD}SampleTime"),
            "a.csv: found no channel header",
        ),
        (
            whole[..whole.find("0\t1.5").expect("data")].to_owned(),
            "a.csv: found channels without samples",
        ),
    ] {
        let sentence = refusal("a.csv", text);
        assert!(sentence.contains(part), "{sentence}");
    }
}

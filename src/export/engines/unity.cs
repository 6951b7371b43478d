// Surefoot's contacts and events as Unity's animation events and Animator curves.
//
{{head}}
//
// Root motion and Avatars need an FBX: bake with -o take.fbx. Rig tab of its import settings: Animation Type Generic, Avatar Definition Create From
// This Model (or Copy From Other Avatar, the character's), Root node Root; or Humanoid. Then the Animator's Apply Root Motion. A .glb (glTFast,
// UnityGLTF) comes with clips of transforms and without an Avatar: the travel moves the object Root.
// Put this file into a folder called Editor and the .events.json beside the model. Needs the package com.unity.nuget.newtonsoft-json. Select
// the model, then Assets > Surefoot > Make clips with events: an imported clip cannot be changed, so each becomes a .anim beside the model.
// Made again it stays the same asset: what refers to it goes on doing so. A component of the animated object receives the events:
//   void SurefootEvent(AnimationEvent e) { /* e.stringParameter is "foot_down_Left", "push_start", ... */ }
// All of it was read in Unity's documentation, none of it run.
using System.Collections.Generic;
using System.IO;
using System.Linq;
using Newtonsoft.Json.Linq;
using UnityEditor;
using UnityEngine;

public static class SurefootEvents
{
    const string Receiver = "SurefootEvent";

    static string Foot(JToken token) =>
        (string)token["foot"] switch { "left" => "{{left}}", "right" => "{{right}}", _ => "" };

    [MenuItem("Assets/Surefoot/Make clips with events")]
    static void MakeClips()
    {
        foreach (var model in Selection.objects)
        {
            var path = AssetDatabase.GetAssetPath(model);
            var sidecar = Path.ChangeExtension(path, ".events.json");
            if (!File.Exists(sidecar))
            {
                Debug.LogError($"surefoot: there is no {sidecar}");
                continue;
            }
            var reports = JObject.Parse(File.ReadAllText(sidecar));
            var told = new HashSet<string>();
            foreach (var source in AssetDatabase.LoadAllAssetsAtPath(path).OfType<AnimationClip>())
            {
                // The importer keeps clips of its own for the preview.
                if (!source.name.StartsWith("__preview__") && ReportOf(source.name, reports) is (string clip, JObject report))
                {
                    told.Add(clip);
                    MakeClip(source, report, Path.GetDirectoryName(path));
                }
            }
            foreach (var clip in reports.Properties().Select(p => p.Name).Where(name => !told.Contains(name)))
            {
                Debug.LogWarning($"surefoot: {path} has no clip {clip}");
            }
        }
        AssetDatabase.SaveAssets();
    }

    // Of an FBX a clip is called as its take, which may be "Armature|shove".
    static (string, JObject)? ReportOf(string name, JObject reports)
    {
        var clip = name.Substring(name.LastIndexOf('|') + 1);
        return reports[clip] is JObject report ? (clip, report) : null;
    }

    static void MakeClip(AnimationClip source, JObject report, string folder)
    {
        var clip = Object.Instantiate(source);
        var file = string.Concat(source.name.Split(Path.GetInvalidFileNameChars()));
        clip.name = file;
        var events = new List<AnimationEvent>();
        foreach (var told in report["events"])
        {
            var foot = Foot(told);
            events.Add(new AnimationEvent
            {
                time = Mathf.Min((float)told["time"], clip.length),
                functionName = Receiver,
                stringParameter = foot == "" ? (string)told["name"] : $"{told["name"]}_{foot}",
                messageOptions = SendMessageOptions.DontRequireReceiver,
            });
        }
        AnimationUtility.SetAnimationEvents(clip, events.OrderBy(e => e.time).ToArray());
        foreach (var foot in new[] { "left", "right" })
        {
            var name = foot == "left" ? "{{left}}" : "{{right}}";
            var binding = EditorCurveBinding.FloatCurve("", typeof(Animator), $"FootContact_{name}");
            AnimationUtility.SetEditorCurve(clip, binding, ContactCurve(report, foot, clip.length));
        }
        var lower = clip.name.ToLowerInvariant();
        var settings = AnimationUtility.GetAnimationClipSettings(clip);
        settings.loopTime = new[] { "loop", "cycle" }.Any(word => lower.StartsWith(word) || lower.EndsWith(word));
        AnimationUtility.SetAnimationClipSettings(clip, settings);
        var path = $"{folder}/{file}.anim";
        var earlier = AssetDatabase.LoadAssetAtPath<AnimationClip>(path);
        if (earlier == null)
        {
            AssetDatabase.CreateAsset(clip, path);
        }
        else
        {
            // Into the asset that is there: a new one would leave every reference to it empty.
            EditorUtility.CopySerialized(clip, earlier);
            EditorUtility.SetDirty(earlier);
            Object.DestroyImmediate(clip);
        }
    }

    // 1 while any part of the foot is on the ground, 0 else, in steps.
    static AnimationCurve ContactCurve(JObject report, string foot, float length)
    {
        var keys = new List<Keyframe>();
        void Step(float time, float value) =>
            keys.Add(new Keyframe(time, value, float.PositiveInfinity, float.PositiveInfinity));
        var end = -1f; // of the span so far; parts of a foot follow on one another
        foreach (var contact in report["contacts"].Where(c => (string)c["foot"] == foot).OrderBy(c => (float)c["start"]))
        {
            var start = (float)contact["start"];
            if (start > end + 1e-3f)
            {
                if (end >= 0f)
                {
                    Step(end, 0f);
                }
                else if (start > 0f)
                {
                    Step(0f, 0f);
                }
                Step(start, 1f);
            }
            end = Mathf.Max(end, (float)contact["end"]);
        }
        if (keys.Count == 0)
        {
            Step(0f, 0f);
        }
        else if (end < length - 1e-3f)
        {
            Step(end, 0f);
        }
        return new AnimationCurve(keys.ToArray());
    }
}

//! The nodes of a controller's program.

use opcua_types::{DataValue, NodeId, StatusCode, VariableId, Variant};

use super::OpcUaServer;
use super::client::{OpcUaClient, RequestError};
use super::opening;
use super::subscription::Subscription;
use super::values::{Shape, types_of};
use super::wire::explain;
use crate::controller::LinkProtection;
use crate::error::LinkError;
use crate::symbols::{
    Failure, RequiredSymbol, Slot, SymbolAccess, SymbolFound, SymbolServer, SymbolValues, each_once,
};

/// States of a server, in the order of their numbers.
const STATES: [&str; 7] = [
    "Running",
    "Failed",
    "No configuration",
    "Suspended",
    "Shutdown",
    "Test",
    "Communication fault",
];

fn failure(error: RequestError, what: &str) -> Failure {
    match error {
        RequestError::Lost(error) => Failure::Lost(error),
        RequestError::Refused(status) => refused(status, what),
    }
}

fn refused(status: StatusCode, what: &str) -> Failure {
    Failure::refused(format!("{what}: {}", explain(status)))
}

impl SymbolServer for OpcUaServer {
    fn place(&self) -> String {
        self.address.url()
    }

    fn connect(&self) -> Result<Box<dyn SymbolAccess>, LinkError> {
        let mut program = Program {
            client: opening::open(self)?,
            nodes: Vec::new(),
            live: None,
        };
        match program.problem().map_err(Failure::into_error)? {
            Some(text) => Err(LinkError::Refused(text)),
            None => Ok(Box::new(program)),
        }
    }
}

/// A node in use.
struct Node {
    name: String,
    id: NodeId,
    shape: Shape,
}

/// A session with the nodes in use.
struct Program {
    client: OpcUaClient,
    nodes: Vec<Node>,
    /// The subscription to live values, and the indices of its nodes.
    live: Option<(Subscription, Vec<usize>)>,
}

impl Program {
    /// The values of nodes by their indices; all must have a good status.
    fn values(&mut self, indices: &[usize]) -> Result<Vec<Variant>, Failure> {
        let ids: Vec<NodeId> = indices.iter().map(|k| self.nodes[*k].id.clone()).collect();
        let answers = self.client.read(&ids);
        let answers = answers.map_err(|error| failure(error, "reading nodes"))?;
        let values = indices.iter().zip(answers);
        values
            .map(|(index, answer)| self.good(*index, answer))
            .collect()
    }

    /// The value of a node, which must have a good status.
    fn good(&self, index: usize, answer: DataValue) -> Result<Variant, Failure> {
        match (answer.status.unwrap_or(StatusCode::Good), answer.value) {
            (status, value) if status.is_good() => Ok(value.unwrap_or_default()),
            (status, _) => Err(refused(status, &self.nodes[index].name)),
        }
    }

    /// Contents of nodes by their indices.
    fn contents(&self, values: &[(usize, Variant)]) -> Result<SymbolValues, Failure> {
        let mut contents = vec![None; self.nodes.len()];
        for (index, value) in values {
            let node = &self.nodes[*index];
            let content = node.shape.content(value);
            contents[*index] = Some(content.ok_or_else(|| node_changed(node, value))?);
        }
        Ok(SymbolValues(contents))
    }

    fn end_live(&mut self) -> Result<(), Failure> {
        let Some((subscription, _)) = self.live.take() else {
            return Ok(());
        };
        let ended = self.client.end_subscription(&subscription);
        ended.map_err(|error| failure(error, "ending a subscription"))
    }
}

impl SymbolAccess for Program {
    fn look_up(&mut self, wanted: &[RequiredSymbol]) -> Result<Vec<SymbolFound>, LinkError> {
        self.nodes.clear();
        let ids: Vec<Option<NodeId>> = wanted.iter().map(|w| w.name.parse().ok()).collect();
        let known: Vec<NodeId> = ids.iter().flatten().cloned().collect();
        let answers = self.client.read(&known);
        let answers = answers.map_err(|e| failure(e, "reading nodes").into_error())?;
        let mut answers = answers.into_iter();
        let mut all = Vec::with_capacity(wanted.len());
        for (want, id) in wanted.iter().zip(ids) {
            let Some((id, answer)) = id.and_then(|id| Some((id, answers.next()?))) else {
                let text = "this is not a node id such as ns=4;s=GVL_Tautline.moving";
                all.push(SymbolFound::Missing(text.to_owned()));
                continue;
            };
            let status = answer.status.unwrap_or(StatusCode::Good);
            if status.is_bad() {
                all.push(SymbolFound::Missing(explain(status)));
                continue;
            }
            let shape = Shape::of(&answer.value.unwrap_or_default());
            let type_name = shape.name();
            all.push(match want.problem(shape.kind(), types_of) {
                None => SymbolFound::Good { type_name },
                Some(why) => SymbolFound::Wrong { type_name, why },
            });
            self.nodes.push(Node {
                name: want.name.clone(),
                id,
                shape,
            });
        }
        Ok(all)
    }

    fn protection(&self) -> LinkProtection {
        match self.client.wire.protection() {
            Some(protection) => LinkProtection::Protected(protection.in_words()),
            None => LinkProtection::Open,
        }
    }

    fn problem(&mut self) -> Result<Option<String>, Failure> {
        let state = NodeId::from(VariableId::Server_ServerStatus_State);
        let answers = self.client.read(&[state]);
        let answers = answers.map_err(|error| failure(error, "the state of the server"))?;
        let state = answers.into_iter().next().and_then(|answer| answer.value);
        Ok(match state {
            Some(Variant::Int32(0)) => None,
            Some(Variant::Int32(state)) => {
                let name = usize::try_from(state).ok().and_then(|k| STATES.get(k));
                let name = name.copied().unwrap_or("Unknown");
                Some(format!("its server does not run, its state is {name:?}"))
            }
            _ => Some("its server does not report its state".to_owned()),
        })
    }

    /// Nodes are addressed by identifiers, which keep their meaning after a change of the program.
    fn check_unchanged(&mut self) -> Result<(), Failure> {
        Ok(())
    }

    fn read(&mut self, indices: &mut dyn Iterator<Item = usize>) -> Result<SymbolValues, Failure> {
        let wanted = each_once(indices, self.nodes.len());
        let values = self.values(&wanted)?;
        let values: Vec<(usize, Variant)> = wanted.into_iter().zip(values).collect();
        self.contents(&values)
    }

    fn subscribe(
        &mut self,
        indices: &mut dyn Iterator<Item = usize>,
        every_s: f64,
    ) -> Result<(), Failure> {
        self.end_live()?;
        let wanted = each_once(indices, self.nodes.len());
        let ids: Vec<NodeId> = wanted.iter().map(|k| self.nodes[*k].id.clone()).collect();
        let made = self.client.subscribe(&ids, every_s);
        let made = made.map_err(|error| failure(error, "subscribing to nodes"))?;
        self.live = Some((made, wanted));
        Ok(())
    }

    fn sent(&mut self) -> Result<Vec<SymbolValues>, Failure> {
        let Some((subscription, wanted)) = &mut self.live else {
            return Ok(Vec::new());
        };
        let rows = match self.client.sent(subscription) {
            Ok(rows) => rows,
            Err(error) => {
                if matches!(error, RequestError::Refused(_)) {
                    self.end_live()?;
                }
                return Err(failure(error, "live values"));
            }
        };
        let wanted = wanted.clone();
        let contents = rows.into_iter().map(|row| {
            let values = wanted.iter().zip(row);
            let values = values.map(|(index, value)| Ok((*index, self.good(*index, value)?)));
            self.contents(&values.collect::<Result<Vec<_>, Failure>>()?)
        });
        contents.collect()
    }

    /// Arrays are read, changed and written as a whole, as not every server can write an element.
    fn write(&mut self, values: &[(Slot, f64)]) -> Result<(), Failure> {
        let mut order: Vec<usize> = Vec::new();
        for (slot, _) in values {
            if slot.symbol < self.nodes.len() && !order.contains(&slot.symbol) {
                order.push(slot.symbol);
            }
        }
        let held = self.values(&order)?;
        let mut written = Vec::with_capacity(order.len());
        for (index, held) in order.iter().zip(held) {
            let node = &self.nodes[*index];
            if Shape::of(&held) != node.shape {
                return Err(node_changed(node, &held));
            }
            let own = values.iter().filter(|(slot, _)| slot.symbol == *index);
            let changes: Vec<(usize, f64)> = own.map(|(slot, v)| (slot.element, *v)).collect();
            let value = node.shape.with(&held, &changes).ok_or_else(|| {
                let (name, kind) = (&node.name, node.shape.name());
                let shown: Vec<String> = changes.iter().map(|(_, v)| v.to_string()).collect();
                let shown = shown.join(", ");
                Failure::refused(format!(
                    "its node {name} of type {kind} cannot hold {shown}"
                ))
            })?;
            written.push((node.id.clone(), value));
        }
        let answers = self.client.write(written);
        let answers = answers.map_err(|error| failure(error, "writing nodes"))?;
        let refusal = order
            .iter()
            .zip(answers)
            .find(|(_, status)| !status.is_good());
        refusal.map_or(Ok(()), |(index, status)| {
            Err(refused(status, &self.nodes[*index].name))
        })
    }
}

/// A value that does not fit the node as it was looked up.
fn node_changed(node: &Node, value: &Variant) -> Failure {
    let found = match value {
        Variant::Empty => "no value (null)".to_owned(),
        value => format!("a value of type {}", Shape::of(value).name()),
    };
    Failure::Lost(LinkError::Disconnected(format!(
        "its node {} sent {found}, expected {}: connect again if its program was changed",
        node.name,
        node.shape.name()
    )))
}

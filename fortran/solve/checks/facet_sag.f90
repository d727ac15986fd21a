!> Flat facets on curved tools, and forces that rise steeply.
!>
!> Where the nodes of a facet lie on a curved tool its middle is off by its sag, h^2/8R, and as
!> uncertain is the place where the tool bears. What the force rises by while the tool moves
!> as far is no better known: little as long as a sheet bends, and most of the force where it is
!> pressed home between a punch and its die. Forces that points have borne before are elastic on the
!> way back to them: the metal has the imprint of the tool as the facets have it, and nothing is
!> uncertain. So are those of formed metal that a run begins with, until it flows.
module lopin_facet_sag
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_stream, only : stream_type
   use lopin_cells, only : cell_type
   use lopin_model, only : model_type
   use lopin_start, only : unseated
   use lopin_carried_force, only : skin_type
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   use lopin_repeated_messages, only : warn_once, note_once
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: sag_type, note_sag, report_sag

   !> Parts of the largest driving force that are told, and warned of.
   real(wp), parameter :: some = 0.02_wp, much = 0.05_wp
   !> Forces that count, beside the largest: where contact begins they rise steeply for a moment.
   real(wp), parameter :: large = 0.5_wp
   !> Beside what all points press, a driving force that is rounding: a ring turns in balance.
   real(wp), parameter :: rounding = 1.0e-6_wp
   !> Plastic part of the work of an increment in which metal flows.
   real(wp), parameter :: flowing = 0.3_wp

   !> The driving force on its way, and where it rose most within the travel of a sag.
   type :: sag_type
      real(wp) :: largest = 0.0_wp             !! driving force so far [force]
      real(wp) :: travel = 0.0_wp              !! since the force was looked at last [length]
      real(wp) :: force = 0.0_wp               !! then; 0: it begins [force]
      real(wp), allocatable :: borne(:)        !! (points) the most until then [force]
      logical :: seated = .false.              !! what the run began with has been borne
      real(wp) :: rise = 0.0_wp                !! the most, of a force that was large [force]
      real(wp) :: to = 0.0_wp                  !! what it rose to [force]
      real(wp) :: sag = 0.0_wp                 !! mean of what pressed there [length]
      real(wp) :: farthest = 0.0_wp            !! the largest of a node [length]
      integer :: pair = 0                      !! that node's
      integer :: step = 0, increment = 0
   contains
      procedure :: keep
   end type sag_type

contains

   !> To a stream or back.
   subroutine keep(self, stream)
      class(sag_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%largest)
      call stream%pass(self%travel)
      call stream%pass(self%force)
      call stream%pass(self%borne)
      call stream%pass(self%seated)
      call stream%pass(self%rise)
      call stream%pass(self%to)
      call stream%pass(self%sag)
      call stream%pass(self%farthest)
      call stream%pass(self%pair)
      call stream%pass(self%step)
      call stream%pass(self%increment)
   end subroutine keep

   !> An increment of the nonlinear path is accepted: how the driving force rose in it.
   subroutine note_sag(self, scene, model, increment, time)
      type(sag_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: increment
      real(wp), intent(in) :: time             !! of the step [time]
      real(wp) :: way, force, sag, farthest, rise, now(scene%newton%contact%n)
      integer :: pair

      now = forces_on_tools(scene%newton%contact, model)
      call begin(self, model, size(now))
      call measure_drive(scene, way, force)
      if (.not. (self%seated .and. way > 0.0_wp)) self%borne = max(self%borne, now)
      if (.not. way > 0.0_wp .or. force <= rounding*sum(now)) return
      self%largest = max(self%largest, force)
      self%travel = self%travel + way
      call measure_sag(scene, model, sag, farthest, pair)
      rise = min(force - self%force, force*share_above(now, self%borne)) &
         & *min(1.0_wp, sag/self%travel)
      if (self%travel >= sag) then
         self%force = force
         self%travel = 0.0_wp
         self%borne = max(self%borne, now)
      end if
      if (.not. self%seated) self%seated = metal_flows(scene) .and. .not. is_unseated(model, &
         & scene%step, time)
      if (self%to < large*self%largest) self%rise = 0.0_wp
      if (rise <= self%rise .or. force < large*self%largest) return
      self%rise = rise
      self%to = force
      self%sag = sag
      self%farthest = farthest
      self%pair = pair
      self%step = scene%step
      self%increment = increment
   end subroutine note_sag

   !> No point has borne anything yet; where a run, or a part of one, begins with formed metal the
   !> mesh does not say what its points have borne.
   pure subroutine begin(self, model, points)
      type(sag_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: points

      if (allocated(self%borne)) then
         if (size(self%borne) == points) return
         deallocate (self%borne)
      end if
      allocate (self%borne(points), source=0.0_wp)
      self%seated = model%start%step == 0 .and. .not. any(model%initial_state%plastic > 0.0_wp)
   end subroutine begin

   !> What points press on tools [force]; others 0.
   pure function forces_on_tools(contact, model) result(force)
      class(nonlinear_contact_type), intent(in) :: contact
      type(model_type), intent(in) :: model
      real(wp) :: force(contact%n)
      integer :: i

      force = 0.0_wp
      do i = 1, contact%n
         if (model%surface(model%pair(contact%pair(i))%master)%tool == 0) cycle
         if (contact%enforcement(i)%tied) cycle
         force(i) = contact%weight(i)*norm2(contact%traction(:, i))
      end do
   end function forces_on_tools

   !> The share of all forces that is above what points have borne.
   pure real(wp) function share_above(force, borne) result(share)
      real(wp), intent(in) :: force(:), borne(:)

      share = 0.0_wp
      if (any(force > 0.0_wp)) share = sum(max(0.0_wp, force - borne))/sum(force)
   end function share_above

   !> A new mesh is still being pressed out of tools.
   pure logical function is_unseated(model, step, time)
      type(model_type), intent(in) :: model
      integer, intent(in) :: step
      real(wp), intent(in) :: time             !! of the step [time]

      is_unseated = .false.
      if (step == model%start%step) is_unseated = unseated(model%start, time, &
         & model%step(step)%period) > 0.0_wp
   end function is_unseated

   !> A part of the work of the increment is plastic.
   pure logical function metal_flows(scene)
      type(scene_type), intent(in) :: scene

      metal_flows = scene%trial%solids%work - scene%accepted%solids%work &
         & > flowing*abs(scene%trial%loads%work - scene%accepted%loads%work)
   end function metal_flows

   !> Longest way of what is prescribed, and the force that drives it.
   pure subroutine measure_drive(scene, way, force)
      type(scene_type), intent(in) :: scene
      real(wp), intent(out) :: way             !! [length]
      real(wp), intent(out) :: force           !! work of the reactions over that way [force]
      real(wp) :: moved
      integer :: id

      way = 0.0_wp
      force = 0.0_wp
      do id = 1, scene%dofs%n
         if (scene%constraints%rule(id)%prescribed == 0) cycle
         moved = scene%trial%motion%u(id) - scene%accepted%motion%u(id)
         way = max(way, abs(moved))
         force = force + scene%trial%loads%reaction(id)*moved
      end do
      if (way > 0.0_wp) force = force/way
   end subroutine measure_drive

   !> Sags around what presses on tools: their mean by the forces, and the largest.
   subroutine measure_sag(scene, model, mean, farthest, sagging)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: mean, farthest  !! [length]
      integer, intent(out) :: sagging          !! pair of the largest; 0: none
      real(wp) :: pressed, weighed, of
      integer :: pair

      pressed = 0.0_wp
      weighed = 0.0_wp
      farthest = 0.0_wp
      sagging = 0
      do pair = 1, size(model%pair)
         if (model%surface(model%pair(pair)%master)%tool == 0) cycle
         call add_pair(scene%newton%contact, pair, pressed, weighed, of)
         if (of <= farthest) cycle
         farthest = of
         sagging = pair
      end do
      mean = 0.0_wp
      if (pressed > 0.0_wp) mean = weighed/pressed
   end subroutine measure_sag

   !> Forces of a pair, and the same times the sags around their nodes.
   subroutine add_pair(contact, pair, pressed, weighed, farthest)
      class(nonlinear_contact_type), intent(in) :: contact
      integer, intent(in) :: pair
      real(wp), intent(inout) :: pressed       !! [force]
      real(wp), intent(inout) :: weighed       !! [energy]
      real(wp), intent(out) :: farthest        !! largest sag of a node [length]
      integer :: point(size(contact%masters%x, 2)), i
      real(wp), dimension(size(point)) :: sag, facets
      real(wp) :: mean, force

      farthest = 0.0_wp
      sag = 0.0_wp
      facets = 0.0_wp
      if (has_flat_facets(contact, pair)) then
         call find_points(contact, pair, point)
         call add_facets(contact, contact%skin(pair), point, sag, facets)
      end if
      do i = 1, contact%n
         if (contact%pair(i) /= pair .or. contact%enforcement(i)%tied) cycle
         force = contact%weight(i)*norm2(contact%traction(:, i))
         pressed = pressed + force
         if (.not. facets(contact%node(i)) > 0.0_wp) cycle
         mean = sag(contact%node(i))/facets(contact%node(i))
         weighed = weighed + force*mean
         farthest = max(farthest, mean)
      end do
   end subroutine add_pair

   !> The tool is met at the nodes of faces, or along curves through these: sheets that are pressed
   !> home are as far off then (docs/release.md).
   pure logical function has_flat_facets(contact, pair)
      class(nonlinear_contact_type), intent(in) :: contact
      integer, intent(in) :: pair

      has_flat_facets = contact%skin(pair)%in_use .and. .not. contact%mortar(pair)%is_on
      if (has_flat_facets) has_flat_facets = .not. any(contact%face%pair == pair .and. .not. &
         & contact%face%curved)
   end function has_flat_facets

   !> The pressed point of each mesh node in a pair: 0: none, or two walls of a corner.
   pure subroutine find_points(contact, pair, point)
      class(nonlinear_contact_type), intent(in) :: contact
      integer, intent(in) :: pair
      integer, intent(out) :: point(:)         !! (nnode)
      integer :: i

      point = 0
      do i = 1, contact%n
         if (contact%pair(i) /= pair .or. contact%status(i) <= 0) cycle
         point(contact%node(i)) = merge(i, -1, point(contact%node(i)) == 0)
      end do
      point = max(point, 0)
   end subroutine find_points

   !> Sags of facets, added up at their nodes.
   pure subroutine add_facets(contact, skin, point, sag, facets)
      class(nonlinear_contact_type), intent(in) :: contact
      type(skin_type), intent(in) :: skin
      integer, intent(in) :: point(:)          !! (nnode) 0: not pressed
      real(wp), intent(inout) :: sag(:)        !! (nnode) [length]
      real(wp), intent(inout) :: facets(:)     !! (nnode) how many have been added
      real(wp) :: normal(3, 8)
      integer :: i, k

      do i = 1, skin%facets%n
         associate (node => skin%facets%node(:skin%facets%nnode(i), i))
            if (count(point(node) > 0) < 2) cycle
            do k = 1, size(node)
               normal(:, k) = 0.0_wp
               if (point(node(k)) > 0) normal(:, k) = contact%normal(:, point(node(k)))
            end do
            sag(node) = sag(node) + sag_of_facet(skin%rules(skin%facets%cell(i))%cell, &
               & contact%masters%x(:, node), normal(:, :size(node)), point(node) > 0)
            facets(node) = facets(node) + 1.0_wp
         end associate
      end do
   end subroutine add_facets

   !> Sag in the middle of a facet: those of two edges that cross add up, and an edge with a node in
   !> its middle has that of its halves.
   pure real(wp) function sag_of_facet(cell, x, normal, presses) result(sag)
      type(cell_type), intent(in) :: cell
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) nodes [length]
      real(wp), intent(in) :: normal(:, :)     !! (3, nnode) of the tool there
      logical, intent(in) :: presses(:)        !! (nnode) edges between such nodes count
      integer :: k, last

      sag = 0.0_wp
      last = merge(1, cell%ncorner, cell%ndim == 1)
      do k = 1, last
         associate (a => cell%edge(1, k), b => cell%edge(2, k), middle => cell%ncorner + k)
            if (cell%quadratic) then
               sag = sag + 0.5_wp*(of_edge(a, middle) + of_edge(middle, b))
            else
               sag = sag + of_edge(a, b)
            end if
         end associate
      end do
      if (last > 1) sag = 0.5_wp*sag

   contains

      pure real(wp) function of_edge(a, b)
         integer, intent(in) :: a, b
         of_edge = 0.0_wp
         if (presses(a) .and. presses(b)) of_edge = abs(sag_of_chord(x(:, b) - x(:, a), &
            & normal(:size(x, 1), b) - normal(:size(x, 1), a)))
      end function of_edge
   end function sag_of_facet

   !> How far a surface stands above its chord in the middle: h^2 kappa/8, > 0 where it bulges.
   pure real(wp) function sag_of_chord(chord, turn)
      real(wp), intent(in) :: chord(:)         !! from one end to the other [length]
      real(wp), intent(in) :: turn(:)          !! normal at the other end less that at the one [-]
      sag_of_chord = dot_product(chord, turn)/8.0_wp
   end function sag_of_chord

   !> The last step ends: say what the sag of facets made of the force.
   subroutine report_sag(self, scene, model)
      type(sag_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text

      if (.not. self%rise > some*self%largest) return
      associate (p => model%pair(self%pair), share => 100.0_wp*self%rise/self%largest)
         text = 'the force rises by '//to_text(share, 2)//' % of its largest in step '// &
            & to_text(self%step)//', increment '//to_text(self%increment)//', within '// &
            & to_text(self%sag, 3)//' of travel, as far as flat facets are off the curved '// &
            & 'tools that they lie on (in the mean by the forces; at most '// &
            & to_text(self%farthest, 3)// &
            & ', pair ('//model%surface(p%slave)%name//', '//model%surface(p%master)%name// &
            & ')): it is known no better'
         if (self%rise > much*self%largest) then
            call warn_once(scene%log, 'W0562', text, p%at, help='half as long facets of the '// &
               & 'slave on curved tools: a quarter of the sag')
         else
            call note_once(scene%log, 'N0562', text, p%at)
         end if
      end associate
   end subroutine report_sag
end module lopin_facet_sag

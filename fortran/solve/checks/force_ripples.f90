!> Ripples of the force of a tool: facets that come to press one by one.
!>
!> A row of contact begins where its node arrives. Over a radius the force rises until the next node
!> bears, and falls as it takes over; on a finer mesh these waves are shorter and lower. What falls
!> and comes back within the travel of a few facets is therefore no property of the scene, and the
!> force is known no better than that. Cycles are counted as loads of fatigue are, by rainflow (ASTM
!> E1049): a fall counts once the force has come back by as much; where it sinks on the whole, a
!> rise that is lost again. What a tool does is seen beside the supports of the part: it may stand
!> while they lead the part along it.
module lopin_force_ripples
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_repeated_messages, only : warn_once, note_once
   use lopin_scene, only : scene_type
   use lopin_led_bodies, only : measure_led
   implicit none
   private
   public :: ripples_type, note_ripples, report_ripples

   !> Falls or rises that are told, and warned of, beside the largest force of the tool.
   real(wp), parameter :: some = 0.02_wp, much = 0.05_wp
   !> Facets that a tool travels from a top of its force to the next at most: it moves slower along
   !> the sheet than in the press.
   real(wp), parameter :: apart = 3.0_wp
   !> Cosine of the angle by which a tool may turn from its way: its force is another one then.
   real(wp), parameter :: straight = 0.9_wp
   !> Turning points of the force that wait to be met again.
   integer, parameter :: most_turns = 24

   !> The force of one tool on its way.
   type :: ripple_type
      real(wp) :: way(3) = 0.0_wp              !! beside the part in the last increment [length]
      real(wp) :: travel = 0.0_wp              !! [length]
      real(wp) :: largest = 0.0_wp             !! force so far [force]
      real(wp) :: wave = 0.0_wp                !! the highest: falls that came back, or the reverse
      real(wp) :: span = 0.0_wp                !! travel from its begin to its end [length]
      real(wp) :: facet = 0.0_wp               !! length of the facets that were pressed then
      integer :: count = 0                     !! waves of more than `some`
      integer :: n = 0
      real(wp) :: force(most_turns) = 0.0_wp, at(most_turns) = 0.0_wp   !! turning points
   contains
      procedure :: keep => keep_one
   end type ripple_type

   type :: ripples_type
      type(ripple_type), allocatable :: of(:)  !! (rigid bodies)
   contains
      procedure :: keep
   end type ripples_type

contains

   !> To a stream or back.
   subroutine keep(self, stream)
      class(ripples_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: i, n

      n = 0
      if (allocated(self%of)) n = size(self%of)
      call stream%pass(n)
      if (stream%reading) then
         if (allocated(self%of)) deallocate (self%of)
         if (stream%broken .or. n < 1) return
         allocate (self%of(n))
      end if
      do i = 1, n
         call self%of(i)%keep(stream)
      end do
   end subroutine keep

   subroutine keep_one(self, stream)
      class(ripple_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: i

      do i = 1, size(self%way)
         call stream%pass(self%way(i))
      end do
      call stream%pass(self%travel)
      call stream%pass(self%largest)
      call stream%pass(self%wave)
      call stream%pass(self%span)
      call stream%pass(self%facet)
      call stream%pass(self%count)
      call stream%pass(self%n)
      do i = 1, size(self%force)
         call stream%pass(self%force(i))
         call stream%pass(self%at(i))
      end do
   end subroutine keep_one

   !> An increment of the nonlinear path is accepted: how the forces of the tools went on in it.
   subroutine note_ripples(self, scene, model)
      type(ripples_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), allocatable :: led(:, :)
      real(wp) :: way(3), force
      integer :: i, body

      if (size(model%rigid_body) == 0) return
      if (.not. allocated(self%of)) allocate (self%of(size(model%rigid_body)))
      call measure_led(scene, led)
      do i = 1, size(self%of)
         way = 0.0_wp
         body = pressed_body(scene, model, i)
         if (body > 0) way = led(:, body)
         call measure_force(scene, model%rigid_body(i)%reference, way, force)
         if (.not. norm2(way) > 0.0_wp) cycle
         associate (tool => self%of(i))
            if (dot_product(way, tool%way) < straight*norm2(way)*norm2(tool%way) .or. &
               & .not. force > 0.0_wp) tool%n = 0
            tool%way = way
            if (force > 0.0_wp) call go_on(tool, norm2(way), force, facet_of(scene, model, i))
         end associate
      end do
   end subroutine note_ripples

   !> How a reference node was led in the increment beside the body that it presses, and the force
   !> that drives it that way; tools that give way to a load have not been led.
   pure subroutine measure_force(scene, node, way, force)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: node
      real(wp), intent(inout) :: way(3)        !! in: of the body that it presses [length]
      real(wp), intent(out) :: force           !! [force]
      real(wp) :: reaction(3)
      logical :: free
      integer :: k

      free = .false.
      reaction = 0.0_wp
      do k = 1, 3
         associate (id => scene%dofs%id(k, node))
            way(k) = -way(k)
            if (id == 0) way(k) = 0.0_wp
            if (id == 0) cycle
            way(k) = way(k) + scene%trial%motion%u(id) - scene%accepted%motion%u(id)
            if (scene%constraints%first(id + 1) > scene%constraints%first(id)) free = .true.
            reaction(k) = scene%trial%loads%reaction(id)
         end associate
      end do
      if (free) way = 0.0_wp
      force = 0.0_wp
      if (norm2(way) > 0.0_wp) force = dot_product(reaction, way)/norm2(way)
   end subroutine measure_force

   !> The deformable body that a rigid body presses most; 0: none.
   integer function pressed_body(scene, model, body) result(pressed)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: body
      real(wp) :: force(0:scene%bodies%nbody)
      logical :: own(size(model%pair))
      integer :: i

      force = 0.0_wp
      own = [(is_master(model, body, i), i=1, size(model%pair))]
      associate (c => scene%newton%contact)
         do i = 1, c%n
            if (c%status(i) <= 0 .or. .not. own(c%pair(i))) cycle
            associate (of => force(scene%bodies%body(c%node(i))))
               of = of + c%weight(i)*norm2(c%traction(:, i))
            end associate
         end do
      end associate
      force(0) = 0.0_wp
      pressed = 0
      if (any(force > 0.0_wp)) pressed = maxloc(force, dim=1) - 1
   end function pressed_body

   !> The master of a pair is a rigid body.
   pure logical function is_master(model, body, pair)
      type(model_type), intent(in) :: model
      integer, intent(in) :: body, pair

      is_master = .false.
      associate (master => model%surface(model%pair(pair)%master))
         if (master%tool > 0) then
            is_master = model%tool(master%tool)%rigid_body == body
         else if (allocated(master%element)) then
            if (size(master%element) > 0) is_master = any(model%rigid_body(body)%node &
               & == model%mesh%conn(1, master%element(1)))
         end if
      end associate
   end function is_master

   !> Length of the longest facet that a rigid body presses [length].
   pure real(wp) function facet_of(scene, model, body) result(length)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: body
      integer :: i, tool

      length = 0.0_wp
      associate (c => scene%newton%contact)
         do i = 1, c%n
            if (c%status(i) <= 0) cycle
            tool = model%surface(model%pair(c%pair(i))%master)%tool
            if (tool > 0) then
               if (model%tool(tool)%rigid_body /= body) cycle
            end if
            length = max(length, c%size(i))
         end do
      end associate
   end function facet_of

   !> The next point of the curve; waves that have come back leave the list of turning points.
   pure subroutine go_on(self, moved, force, facet)
      type(ripple_type), intent(inout) :: self
      real(wp), intent(in) :: moved, force, facet
      real(wp) :: wave

      self%travel = self%travel + moved
      self%largest = max(self%largest, force)
      if (self%n == most_turns) self%n = 0
      if (self%n > 1) then
         ! On in the same direction: the last point was no turning point.
         if ((force - self%force(self%n))*(self%force(self%n) - self%force(self%n - 1)) &
            & >= 0.0_wp) self%n = self%n - 1
      end if
      do while (self%n > 1)
         wave = abs(self%force(self%n - 1) - self%force(self%n))
         if (abs(force - self%force(self%n)) < wave) exit
         call note_wave(self, wave, self%travel - self%at(self%n - 1), facet)
         self%n = self%n - 2
      end do
      self%n = self%n + 1
      self%force(self%n) = force
      self%at(self%n) = self%travel
   end subroutine go_on

   pure subroutine note_wave(self, wave, span, facet)
      type(ripple_type), intent(inout) :: self
      real(wp), intent(in) :: wave             !! its height [force]
      real(wp), intent(in) :: span, facet      !! [length]

      if (span > apart*facet) return
      if (wave > some*self%largest) self%count = self%count + 1
      if (wave <= self%wave) return
      self%wave = wave
      self%span = span
      self%facet = facet
   end subroutine note_wave

   !> The last step ends: say how far the forces of the tools rose and fell with the facets.
   subroutine report_ripples(self, scene, model)
      type(ripples_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text
      integer :: i

      if (.not. allocated(self%of)) return
      do i = 1, size(self%of)
         associate (tool => self%of(i), body => model%rigid_body(i))
            if (.not. tool%wave > some*tool%largest) cycle
            text = 'the force of '//body%name//' falls and rises by '// &
               & to_text(100.0_wp*tool%wave/tool%largest, 2)//' % of its largest while tool '// &
               & 'and part move by '//to_text(tool%span, 3)//' beside each other, '// &
               & to_text(tool%span/tool%facet, 2)//' of a facet (waves above '// &
               & to_text(100.0_wp*some, 1)//' %: '//to_text(tool%count)//'): facets come to '// &
               & 'press one by one, and the force is known no better'
            if (tool%wave > much*tool%largest) then
               call warn_once(scene%log, 'W0561', text, body%at, help='half as long facets '// &
                  & 'where the slave passes the radii of the tools'//rolls(model)//'; means '// &
                  & 'over the travel of a facet are better than single values')
            else
               call note_once(scene%log, 'N0561', text, body%at)
            end if
         end associate
      end do
   end subroutine report_ripples

   !> What else helps in the plane, where no pair has it.
   pure function rolls(model) result(text)
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text

      text = ''
      if (model%mesh%ndim == 2 .and. .not. any(model%pair%smooth)) text = ', or, of linear '// &
         & 'ones, SMOOTH=YES on *CONTACT PAIR'
   end function rolls
end module lopin_force_ripples

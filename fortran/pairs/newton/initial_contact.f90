!> Quantities measured once, in the state in which contact is first evaluated: ties, walls of
!> surfaces in contact with themselves, and how far a new mesh reaches into tools.
module lopin_initial_contact
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_start, only : unseated
   use lopin_model, only : model_type
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   use lopin_search, only : cost_type
   use lopin_master_surfaces, only : move_masters
   use lopin_nonlinear_samples, only : offset_of
   use lopin_mortar_element, only : update_mortar
   use lopin_contact_detection, only : find_closest_features, detect_contact, take_anchor
   implicit none
   private
   public :: measure_initial_contact, apply_overclosures

   !> Gap of nodes inside a tool that bear nothing, where a part begins, in facets.
   real(wp), parameter :: stand_off = 1.0e-6_wp

contains

   !> The share of overclosures that an increment applies, and whether it applies any: an
   !> interference in the first step, or what a part's new mesh is inside tools.
   pure subroutine apply_overclosures(self, model, step, from, until, period)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: step
      real(wp), intent(in) :: from, until      !! of the step [time]
      real(wp), intent(in) :: period           !! of the step [time]

      self%early_share = 1.0_wp
      if (step == 1) self%early_share = until/period
      self%interference = 1.0_wp
      self%closes_in = step == 1 .and. model%start%step == 0
      if (model%start%step == step) then
         self%interference = 1.0_wp - unseated(model%start, until, period)
         self%closes_in = unseated(model%start, from, period) > 0.0_wp
      end if
      self%closes_in = self%closes_in .and. allocated(self%overclosure)
      if (self%closes_in) self%closes_in = any(abs(self%overclosure) > 0.0_wp)
   end subroutine apply_overclosures

   !> Ties and walls as these displacements have them.
   subroutine measure_initial_contact(self, model, u, error)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof) [length]
      type(error_type), allocatable, intent(out) :: error
      type(cost_type) :: cost
      integer :: i, pair

      self%met_at = u
      call move_masters(self%masters, model, self%dofs, self%nonlinear_points_type, u, .true., &
         & cost, error)
      if (allocated(error)) return
      if (model%start%seating > 0.0_wp) call measure_overclosures(self, model, error)
      if (allocated(error)) return
      if (.not. any(self%enforcement%tied)) return
      self%tied_at = self%masters%x
      do pair = 1, size(self%mortar)
         if (.not. (self%mortar(pair)%is_on .and. self%mortar(pair)%tied)) cycle
         associate (master => self%masters%of(pair))
            master%surface%outlook = master%surface%disc(4:6, :)
            call update_mortar(self%mortar(pair), self%masters%rules, master%surface, master%tree, &
               & self%tied_at, .true., .false., error)
            if (allocated(error)) return
         end associate
      end do
      do i = 1, self%n
         if (.not. self%enforcement(i)%tied) cycle
         call detect_contact(self, model, i, .true.)
         call take_anchor(self, model, i)
         self%anchor(i)%offset = offset_of(self%masters, self%nonlinear_points_type, i)
      end do
   end subroutine measure_initial_contact

   !> How far points of a part's new mesh are inside what they meet, beyond what the tractions that
   !> they start with press into a penalty: facets were longer, and their middles lay inside.
   subroutine measure_overclosures(self, model, error)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: traction(3, self%n), gap, pressure
      integer :: i

      call find_closest_features(self, .true., .false., error)
      if (allocated(error)) return
      call start_tractions(traction)
      do i = 1, self%n
         associate (law => self%enforcement(i), opposite => self%opposite(i), &
            & master => self%masters%of(self%pair(i)))
            self%overclosure(i) = 0.0_wp
            ! Mean gaps of a mortar are pressed out at rest: no node is known to be inside.
            if (law%tied .or. master%against_itself .or. self%mortar(self%pair(i))%is_on) cycle
            call detect_contact(self, model, i, .true.)
            if (opposite%facet == 0) cycle
            gap = opposite%found%gap
            if (master%tool > 0) gap = opposite%foot%gap
            pressure = dot_product(traction(:, i), opposite%normal)
            self%overclosure(i) = -gap - law%method%penetration(pressure, self%slope(i))
            ! A penalty bears by what it is pressed in: there it is where the part begins.
            if (.not. (law%method%solves_for_multiplier() .or. law%method%updates())) &
               & self%overclosure(i) = self%overclosure(i) - pressure/self%slope(i)
            ! What bears nothing is open, and stays so at rest.
            if (.not. pressure > 0.0_wp) self%overclosure(i) = max(0.0_wp, self%overclosure(i) &
               & + stand_off*self%size(i))
         end associate
      end do

   contains

      pure subroutine start_tractions(traction)
         real(wp), intent(out) :: traction(:, :)
         integer :: k, point

         traction = 0.0_wp
         if (.not. allocated(model%initial_traction)) return
         do k = 1, size(model%initial_traction)
            associate (t => model%initial_traction(k))
               do point = 1, self%n
                  if (self%node(point) == t%node .and. self%pair(point) == t%pair) &
                     & traction(:, point) = t%traction
               end do
            end associate
         end do
      end subroutine start_tractions
   end subroutine measure_overclosures
end module lopin_initial_contact

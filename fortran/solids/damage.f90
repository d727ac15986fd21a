!> Damage at the integration points: how it grows in an accepted increment, and its mean over a
!> length.
!>
!> A memory has two rows for each criterion that some material of the model names, in the order of
!> `damage_names`: D, and f at the end of the increment before (-1: none yet). The integral is taken
!> by the trapezoidal rule, by f at the end where there is none before.
!>
!> The mean is over the volume around a point in the present shape, by Bazant's bell
!> (1 - (r/width)^2)^2, which counts as much as a uniform mean over 16/15 of `width` along a line.
!> It ends at the skin of the body and where another material begins.
module lopin_damage
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_model, only : model_type
   use lopin_solids, only : solids_type
   use lopin_state, only : solids_state_type
   use lopin_damage_criteria, only : damage_type, damage_names, damage_rate
   use lopin_material_memory, only : strain_at
   use lopin_recover_nonlinear, only : recover_nonlinear
   use lopin_point_states, only : states_of_points
   use lopin_point_bins, only : point_bins_type
   use lopin_bodies, only : bodies_type, connect
   implicit none
   private
   public :: damage_kinds, is_averaged, new_damage, grow_damage, mean_damage, criterion_of

contains

   !> The criteria that some material names, in the order of their names.
   pure function damage_kinds(model) result(kinds)
      type(model_type), intent(in) :: model
      integer, allocatable :: kinds(:)
      logical :: used(size(damage_names))
      integer :: i, k, n

      used = .false.
      do i = 1, size(model%material)
         if (.not. allocated(model%material(i)%damage)) cycle
         used(model%material(i)%damage%kind) = .true.
      end do
      allocate (kinds(count(used)))
      n = 0
      do k = 1, size(used)
         if (.not. used(k)) cycle
         n = n + 1
         kinds(n) = k
      end do
   end function damage_kinds

   !> Whether some material takes the mean of a criterion.
   pure logical function is_averaged(model, kind)
      type(model_type), intent(in) :: model
      integer, intent(in) :: kind
      integer :: i

      is_averaged = .false.
      do i = 1, size(model%material)
         if (allocated(model%material(i)%damage)) is_averaged = is_averaged &
            & .or. any(model%material(i)%damage%kind == kind &
            & .and. model%material(i)%damage%width > 0.0_wp)
      end do
   end function is_averaged

   !> The criterion of a kind that a material has; its kind is 0 if it has none.
   pure function criterion_of(model, section, kind) result(criterion)
      type(model_type), intent(in) :: model
      integer, intent(in) :: section, kind
      type(damage_type) :: criterion
      integer :: i

      criterion = damage_type()
      associate (material => model%material(model%section(section)%material))
         if (.not. allocated(material%damage)) return
         do i = 1, size(material%damage)
            if (material%damage(i)%kind == kind) criterion = material%damage(i)
         end do
      end associate
   end function criterion_of

   !> No damage yet where points remember, or that of the start; nothing is kept if no material
   !> asks.
   subroutine new_damage(memory, model)
      type(solids_state_type), intent(inout) :: memory
      type(model_type), intent(in) :: model
      integer, allocatable :: kinds(:)
      integer :: i, k, p, q

      allocate (kinds, source=damage_kinds(model))
      if (size(kinds) == 0 .or. .not. memory%in_use) return
      allocate (memory%damage(2*size(kinds), size(memory%value, 2)), source=0.0_wp)
      memory%damage(2::2, :) = -1.0_wp
      if (.not. allocated(model%initial_state)) return
      do i = 1, size(model%initial_state)
         associate (state => model%initial_state(i))
            p = memory%first(state%element)
            q = memory%first(state%element + 1) - 1
            if (state%point > 0) q = min(q, p + state%point - 1)
            if (state%point > 0) p = p + state%point - 1
            do k = 1, size(kinds)
               memory%damage(2*k - 1, p:q) = state%damage(kinds(k))
            end do
         end associate
      end do
      do i = 1, size(model%start%kept)
         associate (kept => model%start%kept(i))
            p = memory%first(kept%element) + kept%point - 1
            if (kept%point > 0 .and. p < memory%first(kept%element + 1)) &
               & memory%damage(1::2, p) = kept%damage(kinds)
         end associate
      end do
   end subroutine new_damage

   !> Add what an increment did.
   subroutine grow_damage(self, model, motion, past, before, after)
      type(solids_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: motion(:)                !! (n) displacements by equation [length]
      type(solids_state_type), intent(in) :: past      !! what its stresses were found from
      type(solids_state_type), intent(in) :: before    !! what was accepted before it
      type(solids_state_type), intent(inout) :: after  !! what it leaves
      real(wp), allocatable :: stress(:, :), strain(:, :), step(:)
      real(wp) :: u(3, model%mesh%nnode)
      integer, allocatable :: kinds(:)
      integer :: e, k, p, q, row, from

      if (.not. allocated(after%damage)) return
      allocate (kinds, source=damage_kinds(model))
      u = nodal(self, motion)
      call recover_nonlinear(self, model%mesh, u, past, stress, strain)
      do e = 1, model%mesh%nelement
         p = after%first(e)
         q = after%first(e + 1) - 1
         if (q < p) cycle
         associate (group => self%group(self%which(e)))
            row = strain_at(group%element%nstress)
            step = max(0.0_wp, after%value(row, p:q) - before%value(row, p:q))
            from = self%first_point(e)
            do k = 1, size(kinds)
               call add(criterion_of(model, model%mesh%section(e), kinds(k)), &
                  & contraction_of(model, model%mesh%section(e)), &
                  & before%damage(2*k - 1:2*k, p:q), after%damage(2*k - 1:2*k, p:q))
            end do
         end associate
      end do

   contains

      !> One criterion at the points of an element.
      subroutine add(criterion, poisson, old, new)
         type(damage_type), intent(in) :: criterion
         real(wp), intent(in) :: poisson               !! [-]
         real(wp), intent(in) :: old(:, :)             !! (2, points)
         real(wp), intent(inout) :: new(:, :)          !! (2, points)
         real(wp) :: f, first
         integer :: i

         if (criterion%kind == 0) return
         do i = 1, size(step)
            f = damage_rate(criterion, poisson, stress(:, from + i - 1))
            first = merge(old(2, i), f, old(2, i) >= 0.0_wp)
            if (f >= 0.0_wp) new(1, i) = old(1, i) + 0.5_wp*(f + first)*step(i)
            new(2, i) = f
         end do
      end subroutine add
   end subroutine grow_damage

   !> Poisson's ratio that the deck gives a section; of a rigid one without *ELASTIC that of its
   !> moduli [-].
   pure real(wp) function contraction_of(model, section) result(poisson)
      type(model_type), intent(in) :: model
      integer, intent(in) :: section

      associate (material => model%material(model%section(section)%material))
         poisson = merge(material%given_poisson, material%poisson, material%has_elastic)
      end associate
   end function contraction_of

   !> Displacements by node [length].
   pure function nodal(self, motion) result(u)
      type(solids_type), intent(in) :: self
      real(wp), intent(in) :: motion(:)
      real(wp) :: u(3, size(self%dof, 2))
      integer :: node, k

      u = 0.0_wp
      do node = 1, size(u, 2)
         do k = 1, 3
            if (self%dof(k, node) > 0) u(k, node) = motion(self%dof(k, node))
         end do
      end do
   end function nodal

   !> Damage of each column of a memory and its mean over the width of its criterion.
   subroutine mean_damage(self, model, u, memory, mean)
      type(solids_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(wp), contiguous, intent(in) :: u(:)         !! (n) displacements by equation [length]
      type(solids_state_type), intent(in) :: memory    !! accepted with them
      real(wp), allocatable, intent(out) :: mean(:, :) !! (criterion, column)
      type(point_bins_type) :: bins
      real(wp), allocatable :: table(:, :), width(:)
      integer, allocatable :: kinds(:), other(:), body(:), material(:)
      integer :: k, j
      real(wp) :: weight

      allocate (kinds, source=damage_kinds(model))
      mean = memory%damage(1::2, :)
      allocate (width(size(memory%damage, 2)))
      do k = 1, size(kinds)
         call find_widths(model, memory%first, kinds(k), width)
         if (.not. any(width > 0.0_wp)) cycle
         if (.not. allocated(table)) then
            call states_of_points(self, model%mesh, u, memory, table)
            call find_owners(model, memory%first, body, material)
         end if
         call bins%fill(table(3:5, :), maxval(width))
         do j = 1, size(width)
            if (.not. width(j) > 0.0_wp) cycle
            call bins%near(table(3:5, j), other)
            weight = 0.0_wp
            mean(k, j) = 0.0_wp
            call add_bell(other, j)
            mean(k, j) = mean(k, j)/weight
         end do
      end do

   contains

      !> Points of the same metal in the same body.
      subroutine add_bell(other, j)
         integer, intent(in) :: other(:), j
         integer :: i
         real(wp) :: far, share

         do i = 1, size(other)
            if (body(other(i)) /= body(j) .or. material(other(i)) /= material(j)) cycle
            far = sum((table(3:5, other(i)) - table(3:5, j))**2)/width(j)**2
            if (far >= 1.0_wp) cycle
            share = (1.0_wp - far)**2*table(6, other(i))
            weight = weight + share
            mean(k, j) = mean(k, j) + share*memory%damage(2*k - 1, other(i))
         end do
      end subroutine add_bell
   end subroutine mean_damage

   !> The body and the material of each column of a memory.
   subroutine find_owners(model, first, body, material)
      type(model_type), intent(in) :: model
      integer, intent(in) :: first(:)          !! (nelement + 1) columns of elements
      integer, allocatable, intent(out) :: body(:), material(:)
      type(bodies_type) :: bodies
      integer :: e

      call connect(bodies, model)
      allocate (body(first(size(first)) - 1), material(first(size(first)) - 1), source=0)
      do e = 1, model%mesh%nelement
         if (first(e + 1) == first(e)) cycle
         body(first(e):first(e + 1) - 1) = bodies%body(model%mesh%conn(1, e))
         material(first(e):first(e + 1) - 1) = model%section(model%mesh%section(e))%material
      end do
   end subroutine find_owners

   !> The width of a criterion at each column of a memory; 0 where it has none [length].
   subroutine find_widths(model, first, kind, width)
      type(model_type), intent(in) :: model
      integer, intent(in) :: first(:)          !! (nelement + 1)
      integer, intent(in) :: kind
      real(wp), intent(out) :: width(:)
      type(damage_type) :: criterion
      integer :: e

      width = 0.0_wp
      do e = 1, model%mesh%nelement
         if (first(e + 1) == first(e)) cycle
         criterion = criterion_of(model, model%mesh%section(e), kind)
         width(first(e):first(e + 1) - 1) = criterion%width
      end do
   end subroutine find_widths
end module lopin_damage

!> What lies behind a surface: its materials, and the yield stress that laws of friction read there.
module lopin_surface_material
   use lopin_kinds, only : wp
   use lopin_model, only : model_type, surface_of
   implicit none
   private
   public :: pair_materials, slave_yields

contains

   !> Which materials a pair rubs: those behind the slave, or behind the master if the slave has
   !> none (a rigid slave).
   pure subroutine pair_materials(model, pair, used)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      logical, intent(out) :: used(:)      !! (nmaterial)

      used = .false.
      call mark(model, model%pair(pair)%slave, used)
      if (.not. any(used)) call mark(model, model%pair(pair)%master, used)
   end subroutine pair_materials

   pure subroutine mark(model, surface, used)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      logical, intent(inout) :: used(:)
      integer :: e, k
      logical :: behind(model%mesh%nelement)

      call find_elements(model, surface, behind)
      do e = 1, model%mesh%nelement
         if (.not. behind(e) .or. model%mesh%section(e) == 0) cycle
         k = model%section(model%mesh%section(e))%material
         if (k > 0) used(k) = .true.
      end do
   end subroutine mark

   !> The elements behind a surface: those of its faces, or those that hold its nodes.
   pure subroutine find_elements(model, surface, behind)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      logical, intent(out) :: behind(:)    !! (nelement)
      logical :: on(0:model%mesh%nnode)
      integer :: e

      behind = .false.
      on = .false.
      associate (s => model%surface(surface))
         if (s%kind == surface_of%faces) then
            behind(s%element) = .true.
         else if (s%kind == surface_of%nodes) then
            on(s%node) = .true.
            do e = 1, model%mesh%nelement
               behind(e) = any(on(model%mesh%conn(:, e)))
            end do
         end if
      end associate
   end subroutine find_elements

   !> The least yield stress of the elements behind the slave at each of their nodes; 0 where
   !> none is known.
   pure subroutine slave_yields(model, pair, yield)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(out) :: yield(:)    !! (nnode) [stress]
      logical :: behind(model%mesh%nelement)
      real(wp) :: own
      integer :: e, a, material, node

      yield = 0.0_wp
      call find_elements(model, model%pair(pair)%slave, behind)
      do e = 1, model%mesh%nelement
         if (.not. behind(e) .or. model%mesh%section(e) == 0) cycle
         material = model%section(model%mesh%section(e))%material
         if (material == 0) cycle
         own = model%material(material)%yield
         if (.not. own > 0.0_wp) cycle
         do a = 1, size(model%mesh%conn, 1)
            node = model%mesh%conn(a, e)
            if (node == 0) exit
            if (yield(node) > 0.0_wp) then
               yield(node) = min(yield(node), own)
            else
               yield(node) = own
            end if
         end do
      end do
   end subroutine slave_yields
end module lopin_surface_material

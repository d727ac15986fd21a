!> The materials behind a surface, and the yield stress that laws of friction read there.
module lopin_surface_material
   use lopin_kinds, only : wp
   use lopin_flow_curve, only : flows
   use lopin_model, only : model_type, surface_of
   implicit none
   private
   public :: pair_materials, is_metal, slave_yields, youngs_modulus, extreme_moduli

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

   !> The material behind a surface flows.
   pure logical function is_metal(model, surface)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      logical :: used(size(model%material))
      integer :: k

      used = .false.
      call mark(model, surface, used)
      is_metal = any([(used(k) .and. flows(model%material(k)%flow), k=1, size(used))])
   end function is_metal

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

   !> Young's modulus of an element that has a section, also of a neo-Hookean one.
   pure real(wp) function youngs_modulus(model, element) result(young)
      type(model_type), intent(in) :: model
      integer, intent(in) :: element
      real(wp) :: g, k

      associate (m => model%material(model%section(model%mesh%section(element))%material))
         young = m%young
         if (.not. m%has_neo_hooke) return
         g = 2.0_wp*m%c10
         young = 3.0_wp*g
         if (.not. m%d1 > 0.0_wp) return
         k = 2.0_wp/m%d1
         young = 9.0_wp*k*g/(3.0_wp*k + g)
      end associate
   end function youngs_modulus

   !> The softest and the stiffest of some elements; huge and 0 where all are rigid.
   pure subroutine extreme_moduli(model, element, softest, stiffest)
      type(model_type), intent(in) :: model
      integer, intent(in) :: element(:)
      real(wp), intent(out) :: softest, stiffest   !! [stress]
      integer :: i

      softest = huge(1.0_wp)
      stiffest = 0.0_wp
      do i = 1, size(element)
         if (model%mesh%section(element(i)) == 0) cycle
         softest = min(softest, youngs_modulus(model, element(i)))
         stiffest = max(stiffest, youngs_modulus(model, element(i)))
      end do
   end subroutine extreme_moduli
end module lopin_surface_material
